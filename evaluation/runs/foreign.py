# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads of another make, drawn with known truth, beside plain optical flow.

    .venv/bin/python -m evaluation.runs.foreign --set tuning [--tracker crop_height=400 ...]

Prints for each way of moving the head and each size of picture how much of the face's motion is
explained, the error of moving points beside that of direct DIS, and how far the neutral's depth is
off. `scripts/fetch_foreign_face` fetches the mesh; the clips are drawn once. How the heads are made
and what the columns are: docs/measured/foreign-heads.md.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, _core
from mimetic.media.footage import Footage
from mimetic.score.json_text import json_text
from mimetic.score.peers import dis_tracks
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture
from numpy.typing import NDArray

from evaluation.progress import to_stderr
from evaluation.runs import deviation
from evaluation.runs.ablations import Variant, VariedCapture, variant_of
from evaluation.runs.deviation import Explained
from evaluation.runs.expressions import seen_at_start
from evaluation.runs.methods import DIRECT, MUSCLES, OURS, Motion, of_performance
from evaluation.synthetic.clips import CannotRender
from evaluation.synthetic.foreign.films import film_clips
from evaluation.synthetic.foreign.recipes import SETS, Film

FIGURES = {
    "r2": ("R2 with detail", ".3f"),
    "muscles": ("muscles alone", ".3f"),
    "direct_r2": ("DIS direct", ".3f"),
    "px": ("moving px", ".2f"),
    "direct_px": ("DIS px", ".2f"),
    "ratio": ("of DIS", ".2f"),
    "depth": ("depth mm", ".1f"),
    "sides": ("sides mm", ".1f"),
    "turn": ("turn deg", ".2f"),
    "milliseconds": ("ms a frame", ".0f"),
}
SIDE_SHARE = (
    0.6  # of the face's half width, from which points count as sides; the chin's height too
)
Report = Callable[[str], None]


@dataclass(frozen=True)
class ForeignScore:
    """What one clip says, ready to be pooled with others."""

    clip: str
    head: str  # how it moves
    size: str
    explained: dict[str, Explained]  # pixels, by method
    depth_mm: NDArray[np.float64]  # K, error along the line of sight at the start; nan off the face
    is_side: NDArray[np.bool_]  # K
    turn_deg: float  # median over the frames
    milliseconds: float  # of the tracker, a frame


def score_set(which: str, variant: Variant, report: Report) -> Iterator[ForeignScore]:
    """Every film of a set at every size, drawn if missing; raises CannotRender, OSError."""
    for film in SETS[which]:
        for size, clip in film_clips(film, report).items():
            report(f"{clip.name}: capturing")
            yield score_clip(film, size, clip.footage, Truth.load(clip.truth), variant)


def score_clip(
    film: Film, size: str, path: Path, whole_truth: Truth, variant: Variant
) -> ForeignScore:
    truth = seen_at_start(whole_truth)
    start = truth.tracks[0]
    capturing = VariedCapture(Footage(path), clip_capture.find_face(path), variant)
    performance = capturing.run()
    images = [image for _, image in Footage(path)]
    motions = {
        OURS: of_performance(performance, start),
        MUSCLES: of_performance(performance.without_detail(), start),
        DIRECT: Motion(dis_tracks(images, start)["direct"]),
    }
    explained = {
        name: Explained.of(deviation.in_image(truth, motion), slice(None))
        for name, motion in motions.items()
    }
    depth, is_side = depth_errors(truth.points[0], motions[OURS].points[0])
    seconds = sum(capturing.walk.summary.tracker_seconds.values())
    return ForeignScore(
        *(path.stem, film.head, size, explained, depth, is_side),
        turn_deg=float(np.median(turn_errors(truth.head_pose, performance.head_pose))),
        milliseconds=1000 * seconds / performance.num_frames,
    )


def turn_errors(true_poses: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Degrees (N) by which turns since the first frame differ; both N x 4 x 4, camera from head.

    Where a head frame's axes point is each one's own affair and does not count.
    """
    true_turns, turns = (some[:, :3, :3] @ some[0, :3, :3].T for some in (true_poses, poses))
    apart = np.tile(np.eye(4), (len(poses), 1, 1))
    apart[:, :3, :3] = turns @ true_turns.transpose(0, 2, 1)
    return np.degrees(np.ravel(_core.angles_from(apart, np.eye(4))))


def depth_errors(
    true_points: NDArray[np.float64], points: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Errors of depth (K), mm, once turned, moved and scaled onto the true points; which are sides.

    Both K x 3 in a head frame, z to the front; nan where the method has no surface. Sides are what
    lies far from the middle to the left, to the right or below.
    """
    is_known = np.isfinite(points).all(1)
    fitted = _core.fit_similarity(points[is_known], true_points[is_known])
    placed = np.full_like(points, np.nan)
    placed[is_known] = fitted.apply(points[is_known])
    from_middle = true_points - np.median(true_points, axis=0)
    reach = np.abs(from_middle).max(0)
    is_side = (np.abs(from_middle[:, 0]) > SIDE_SHARE * reach[0]) | (
        from_middle[:, 1] < SIDE_SHARE * from_middle[:, 1].min()
    )
    return 1000 * (placed - true_points)[:, 2], is_side


def figures(scores: Iterable[ForeignScore]) -> dict[str, float]:
    """Of one clip, or of several pooled."""
    scores = list(scores)
    pooled = {
        name: Explained.all_of(score.explained[name] for score in scores)
        for name in (OURS, MUSCLES, DIRECT)
    }
    depth = np.concatenate([score.depth_mm for score in scores])
    sides = np.concatenate([score.depth_mm[score.is_side] for score in scores])
    return {
        "r2": pooled[OURS].r2,
        "muscles": pooled[MUSCLES].r2,
        "direct_r2": pooled[DIRECT].r2,
        "px": pooled[OURS].median,
        "direct_px": pooled[DIRECT].median,
        "ratio": pooled[OURS].median / pooled[DIRECT].median,
        "depth": math.sqrt(np.nanmean(depth**2)),
        "sides": math.sqrt(np.nanmean(sides**2)),
        "turn": float(np.mean([score.turn_deg for score in scores])),
        "milliseconds": float(np.mean([score.milliseconds for score in scores])),
    }


def tables(scores: list[ForeignScore]) -> dict[str, dict[str, float]]:
    """Figures by clip, then by how the head moves and the picture's size, then of all."""
    rows = {score.clip: figures([score]) for score in scores}
    for head, size in dict.fromkeys((score.head, score.size) for score in scores):
        chosen = [score for score in scores if (score.head, score.size) == (head, size)]
        rows[f"{head}, {size}"] = figures(chosen)
    rows["all"] = figures(scores)
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.foreign", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--set", choices=SETS, default="held-out", help="default: held-out")
    parser.add_argument(
        "--tracker", nargs="+", default=[], metavar="NAME=VALUE", help="other TrackerOptions"
    )
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    try:
        scores = list(score_set(options.set, variant_of(options.tracker), to_stderr))
    except (CannotRender, InvalidInput, OSError) as error:
        print(f"foreign: {error}", file=sys.stderr)
        return 2
    rows = tables(scores)
    print(json_text(rows) if options.json else text_table("heads of another make", FIGURES, rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
