# SPDX-License-Identifier: GPL-3.0-or-later
"""A real clip captured from one fit under several settings of the tracker.

    .venv/bin/python -m evaluation.runs.settings cap12_edit --last 300 --rest 20:55 \\
        --tracker crop_height=400 sample_spacing=8 --tracker sample_spacing=8

The first row is the tracker as it is. Printed: the largest activation and articulator value in
frames at rest, the widest that the jaw opens, how far it goes aside as the head turns by 10 degrees
(least squares over all frames), and of the points marked by hand in the captured frames
(evaluation/real) the median distance, % of the interpupillary distance.
"""

from __future__ import annotations

import argparse
import math
import sys

import numpy as np
from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.report.plots import head_angles
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.solve import clip_capture

from evaluation.runs.ablations import Variant, VariedCapture, variant_of
from evaluation.runs.real_labels import CLIPS, footage_of, read_labels
from evaluation.runs.real_methods import by_capture
from evaluation.runs.real_score import FEATURES, score_places

AS_IT_IS = "as it is"
RATES = {
    "rest": ("muscle at rest", ".3f"),
    "articulator": ("other at rest", ".3f"),
    "jaw": ("jaw, widest", ".2f"),
    "aside": ("jaw aside, 10° turn", ".2f"),
    "told": ("lips told", ".2f"),
    "milliseconds": ("ms a frame", ".0f"),
}


def captured(clip: str, last: int, variants: dict[str, Variant]) -> dict[str, VariedCapture]:
    """Captures of frames 1 to `last`, ready to run, that start from the same fit."""
    path = footage_of(clip)
    last = min(last, Footage(path).num_frames)
    fit = clip_capture.find_face(path, frames=(1, last))
    made = {}
    for name, variant in variants.items():
        made[name] = VariedCapture(Footage(path), fit, variant)
        made[name].walk.frames = (1, last)
    return made


def motion(performance: Performance, rest: tuple[int, int] | None) -> dict[str, float]:
    """What the jaw does, and what moves in the frames from first to last of rest."""
    jaw, aside = (
        performance.articulator_values[:, performance.articulators.index(name)]
        for name in ("jaw_open", "jaw_side")
    )
    yaw = head_angles(performance)[:, 1]
    turned = yaw - yaw.mean()
    slope = turned @ aside / max(float(turned @ turned), np.finfo(float).tiny)
    values = {"jaw": float(jaw.max()), "aside": 10 * float(slope)}
    if rest is not None:
        is_rest = (performance.frame >= rest[0]) & (performance.frame <= rest[1])
        others = np.abs(performance.articulator_values[is_rest])
        values["rest"] = float(performance.activations[is_rest].max(initial=0.0))
        values["articulator"] = float(others.max(initial=0.0))
    return values


def marked(clip: str, performance: Performance) -> dict[str, float]:
    """How near the performance comes to points marked by hand in its frames; empty without any."""
    labels = read_labels(clip)
    labels = labels.rows(np.isin(labels.frame, performance.frame))
    if not len(labels.frame):
        return {}
    score = score_places(labels, AS_IT_IS, by_capture(labels, performance))
    return {"told": score.lips_told} | {name: of["median"] for name, of in score.figures.items()}


def columns() -> dict[str, tuple[str, str]]:
    return RATES | {feature: (feature, ".1f") for feature in FEATURES}


def frame_range(text: str) -> tuple[int, int]:
    first, _, last = text.partition(":")
    try:
        frames = int(first), int(last)
    except ValueError:
        raise InvalidInput(f"--rest {text}: two frame numbers are needed, such as 20:55") from None
    if frames[0] > frames[1]:
        raise InvalidInput(f"--rest {text}: the first frame comes after the last")
    return frames


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.settings", description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("clip", choices=CLIPS)
    parser.add_argument("--last", type=int, default=300, help="frame to stop at (default: 300)")
    parser.add_argument("--rest", metavar="A:B", help="frames in which the face is at rest")
    parser.add_argument(
        "--tracker", nargs="+", action="append", default=[], metavar="NAME=VALUE", help="a row more"
    )
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    rows: dict[str, dict[str, float]] = {}
    try:
        rest = frame_range(options.rest) if options.rest else None
        variants = {AS_IT_IS: Variant()}
        variants |= {" ".join(words): variant_of(words) for words in options.tracker}
        for name, capturing in captured(options.clip, options.last, variants).items():
            print(f"{options.clip}: {name}", file=sys.stderr, flush=True)
            performance = capturing.run()
            seconds = math.fsum(capturing.walk.summary.tracker_seconds.values())
            rows[name] = motion(performance, rest) | marked(options.clip, performance)
            rows[name]["milliseconds"] = 1000 * seconds / performance.num_frames
    except (InvalidInput, OSError) as error:
        print(f"settings: {error}", file=sys.stderr)
        return 2
    print(json_text(rows) if options.json else text_table(options.clip, columns(), rows))
    return 0


if __name__ == "__main__":
    sys.exit(main())
