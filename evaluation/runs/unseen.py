# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips of people on whom nothing was chosen: are they followed, and do eyes and lips move alike?

    scripts/fetch_footage --more
    python -m evaluation.runs.unseen [--clips NAME ...]

Nothing is marked on these clips. Each is captured, and shown to MediaPipe's mesh with refined
landmarks: two ways to see the same face that have little in common but the networks for eyes and
lips. Printed are the frames that are held, the correlation of how far lids and lips are apart, how
high the mouth's corners are and how wide it is, how far lids and lips move for what they move in
the mesh (the slope of ours on the mesh's), and what stays between the two when the clip's median
difference is taken away, in % of the interpupillary distance. What differs is wrong in one of the
two, and worth a look.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY
from mimetic.score.text_table import text_table
from mimetic.solve import clip_capture
from numpy.typing import NDArray

from evaluation.progress import to_stderr
from evaluation.runs.head_clips import face_mesh_python
from evaluation.runs.real_labels import POINTS, Labels
from evaluation.runs.real_methods import REFINED_MESH_POINTS, by_capture, run_face_mesh
from evaluation.runs.rendered import CHECKOUT

FOLDER = CHECKOUT / "build" / "footage" / "more"
CLIPS = ("carphone_pristine", "obama_speech", "jwpIntro", "testMovie")
OPENINGS = ("lids", "lips")
WAYS = (*OPENINGS, "corners", "width")
COLUMNS = {
    "frames": ("frames", ".0f"),
    "held": ("held", ".0f"),
    **{f"{way} r": (f"{way} r", ".2f") for way in WAYS},
    **{f"{way} slope": (f"{way} slope", ".2f") for way in OPENINGS},
    **{f"{way} left": (f"{way} left", ".1f") for way in WAYS},
}


def movements(places: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Each N x 1 or 2, % of the interpupillary distance: how far lids (right, left) and lips are
    apart, how far below the eyes the mouth's corners are, and how wide it is.

    places: N x POINTS x 2, pixels
    """

    def of(name: str) -> NDArray[np.float64]:
        return places[:, POINTS.index(name)]

    right, left = ((of(f"eye_outer.{s}") + of(f"eye_inner.{s}")) / 2 for s in "RL")
    pupils = np.linalg.norm(left - right, axis=1, keepdims=True)
    along = (left - right) / pupils
    down = np.stack([-along[:, 1], along[:, 0]], axis=1)

    def share(vectors: NDArray[np.float64], way: NDArray[np.float64]) -> NDArray[np.float64]:
        return 100 * (vectors * way).sum(axis=1) / pupils[:, 0]

    middle = (right + left) / 2
    corners = [of(f"mouth_corner.{s}") for s in "RL"]
    lids = [share(of(f"lid_lower.{s}") - of(f"lid_upper.{s}"), down) for s in "RL"]
    return {
        "lids": np.stack(lids, axis=1),
        "lips": share(of("lip_inner_lower") - of("lip_inner_upper"), down)[:, None],
        "corners": np.stack([share(corner - middle, down) for corner in corners], axis=1),
        "width": share(corners[1] - corners[0], along)[:, None],
    }


def correlation(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Of N values each; nan where one of them does not move."""
    return float(np.corrcoef(a, b)[0, 1]) if min(np.ptp(a), np.ptp(b)) > 0 else math.nan


def slope(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Of N values on N others; nan where these do not move."""
    return float(np.polyfit(b, a, 1)[0]) if np.ptp(b) > 0 else math.nan


def compared(ours: NDArray[np.float64], mesh: NDArray[np.float64]) -> dict[str, float]:
    """Figures of one clip: N x POINTS x 2 each, pixels; nan where one of them sees no face."""
    figures: dict[str, float] = {}
    others = movements(mesh)
    for way, values in movements(ours).items():
        other = others[way]
        seen = np.isfinite(values).all(axis=1) & np.isfinite(other).all(axis=1)
        if seen.sum() < 3:
            continue
        pairs = list(zip(values[seen].T, other[seen].T, strict=True))
        figures[f"{way} r"] = float(np.mean([correlation(a, b) for a, b in pairs]))
        if way in OPENINGS:
            figures[f"{way} slope"] = float(np.mean([slope(a, b) for a, b in pairs]))
        away = [a - b - np.median(a - b) for a, b in pairs]
        figures[f"{way} left"] = float(np.median(np.abs(away)))
    return figures


def score_clip(path: Path, python: Path | None) -> dict[str, float]:
    """python: of scripts/face_mesh_env; without it frames and those held alone. Raises
    InvalidInput."""
    performance = clip_capture.capture(path)
    held = float((performance.quality < HELD_QUALITY).sum())
    figures = {"frames": float(len(performance.frame)), "held": held}
    if python is None:
        return figures
    meshes = run_face_mesh(Footage(path), python, int(performance.frame[-1]))
    mesh = meshes[performance.frame - 1][:, [REFINED_MESH_POINTS[name] for name in POINTS]]
    nothing = np.full(mesh.shape, np.nan)
    labels = Labels(path.stem, performance.frame, nothing, np.zeros(len(mesh)))
    return figures | compared(by_capture(labels, performance), mesh)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.unseen", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--clips", nargs="+", choices=CLIPS, default=CLIPS, metavar="NAME")
    clips = parser.parse_args(arguments).clips
    rows: dict[str, dict[str, float]] = {}
    try:
        python = face_mesh_python(to_stderr)
        for clip in clips:
            path = FOLDER / f"{clip}.mp4"
            if not path.is_file():
                raise InvalidInput(f"{path} is missing: run scripts/fetch_footage --more")
            to_stderr(f"{clip}, capture")
            rows[clip] = score_clip(path, python)
    except (InvalidInput, OSError) as error:
        print(f"unseen: {error}", file=sys.stderr)
        return 2
    print(text_table("unseen", COLUMNS, rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
