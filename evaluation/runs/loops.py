# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 2: its estimator's loop beside ours, and what both make of one clip.

    python -m evaluation.runs.loops PAPER.npz OURS.npz --out LOOPS.png

PAPER.npz is of `python -m evaluation.baselines`, OURS.npz of `mimetic capture`, both of one clip.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np
from mimetic import InvalidInput
from mimetic.performance.document import Performance
from mimetic.score.groups import GROUP_NAMES
from mimetic.shared.whole_file import whole_file

COLOURS = {"the paper's loop": "#c8553d", "ours": "#1b7f79"}
# Boxes from left to right with their lines of text; what goes back from the last to the first
LOOPS = {
    "the paper's loop": (
        ("flow from frame\nto frame", "error of the\nprediction", "Kalman gain", "skin's motion"),
        "muscle controls that make the model follow; they predict the next frame",
    ),
    "ours": (
        (
            "flow with covariance,\nreference texture,\nlids and lips seen",
            "error of pose and\nmuscles together",
            "robust weighted\nleast squares",
            "pose, muscles,\ndetail, deviations",
        ),
        "prediction of the next frame; after the last frame all of it backward in time",
    ),
}


def draw(performances: dict[str, Performance], path: Path) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 7), layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(1, 1.1))
    for panel, name in zip(above.subplots(2, 1), LOOPS, strict=True):
        _draw_loop(panel, name)
    shown = most_moved(performances["ours"])
    panels = below.subplots(1, len(shown), sharey=True)
    for panel, group in zip(panels, shown, strict=True):
        for name, performance in performances.items():
            values = performance.activations[:, performance.groups == group].mean(axis=1)
            panel.plot(performance.frame, values, color=COLOURS[name], lw=1.5, label=name)
        panel.set_title(GROUP_NAMES[group], fontsize=10)
        panel.set_xlabel("frame")
        panel.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("mean activation of the group")
    panels[0].legend(fontsize=8)
    with whole_file(path) as stream:
        figure.savefig(stream, format=path.suffix[1:] or "png", dpi=100)


def most_moved(performance: Performance, number: int = 3) -> list[int]:
    """The groups that do most in the clip, by number."""
    most = {
        group: float(performance.activations[:, performance.groups == group].max(initial=0))
        for group in GROUP_NAMES
    }
    return sorted(sorted(most, key=lambda group: -most[group])[:number])


def _draw_loop(panel: Any, name: str) -> None:
    boxes, back = LOOPS[name]
    colour = COLOURS[name]
    panel.set_xlim(-0.5, len(boxes) - 0.5)
    panel.set_ylim(-0.75, 0.6)
    panel.axis("off")
    panel.set_title(name, loc="left", fontsize=11, color=colour)
    style = {"boxstyle": "round,pad=0.5", "facecolor": "white", "edgecolor": colour, "lw": 1.5}
    for column, text in enumerate(boxes):
        panel.text(column, 0.15, text, ha="center", va="center", fontsize=9, bbox=style)
    arrow = {"arrowstyle": "-|>", "color": colour, "lw": 1.5}
    for column in range(len(boxes) - 1):
        panel.annotate("", (column + 0.66, 0.15), xytext=(column + 0.34, 0.15), arrowprops=arrow)
    last = len(boxes) - 1
    panel.plot([last, last, 1], [-0.15, -0.5, -0.5], color=colour, lw=1.5)
    panel.annotate("", (1, -0.15), xytext=(1, -0.5), arrowprops=arrow)
    panel.text((1 + last) / 2, -0.55, back, ha="center", va="top", fontsize=9)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.loops", description=__doc__)
    parser.add_argument("paper", type=Path, help="performance of the paper's loop")
    parser.add_argument("ours", type=Path, help="performance of a capture of the same clip")
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png or .jpg")
    options = parser.parse_args(arguments)
    try:
        read = {name: Performance.load(path) for name, path in _given(options)}
        if not np.array_equal(*(one.frame for one in read.values())):
            raise InvalidInput("the two performances are not of the same frames")
    except InvalidInput as error:
        print(f"loops: {error}", file=sys.stderr)
        return 2
    draw(read, options.out)
    return 0


def _given(options: argparse.Namespace) -> list[tuple[str, Path]]:
    return [("the paper's loop", options.paper), ("ours", options.ours)]


if __name__ == "__main__":
    sys.exit(main())
