# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Figs. 11 to 14 from one's own footage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimetic.analyse.drawing import GROUP_COLOURS, INK, SOFT, new_figure
from mimetic.performance.document import Performance
from mimetic.puppet.parts import FACE, PARTS
from mimetic.puppet.running import Trace
from mimetic.puppet.templates import TaughtSet
from mimetic.report.plots import COLOURS, GROUPS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NUM_PICTURES = 5
PART_TITLES = {
    "brow.L": "left brow",
    "brow.R": "right brow",
    "eye.L": "left eye",
    "eye.R": "right eye",
    "mouth": "mouth",
    FACE: "whole face",
}


def template_figure(taught: TaughtSet) -> Figure:
    """Figs. 11 and 12: the templates, a row a part, at their resolution."""
    kinds = [kind for kind in (FACE, *PARTS) if taught.of_part(kind)]
    most = max(len(taught.of_part(kind)) for kind in kinds)
    heights = [2.0 if kind == FACE else 0.8 for kind in kinds]
    figure, axes = new_figure(len(kinds), most, (1.3 * most + 1, 1.25 * sum(heights)), sharex=False)
    pictures = taught.pictures
    for kind, row in zip(kinds, axes, strict=True):
        templates = taught.of_part(kind)
        for panel in row:
            panel.axis("off")
        for panel, i in zip(row, templates, strict=False):
            panel.imshow(pictures[i], cmap="gray", vmin=0, vmax=255)
            panel.set_title(taught.looks[taught.template_looks[i]], fontsize=7)
        row[0].text(
            -0.12,
            0.5,
            PART_TITLES[kind],
            transform=row[0].transAxes,
            rotation=90,
            va="center",
            ha="right",
        )
    return figure


def shown_templates(taught: TaughtSet, mode: str) -> dict[str, list[int]]:
    """The templates whose scores are drawn, by title."""
    kinds = (FACE,) if mode == "face" else PARTS
    return {PART_TITLES[kind]: taught.of_part(kind) for kind in kinds if taught.of_part(kind)}


def draw_scores(
    axes: Axes, taught: TaughtSet, trace: Trace, templates: list[int], frame: NDArray
) -> None:
    scores = np.array(trace.scores)
    for k, i in enumerate(templates):
        name = taught.looks[taught.template_looks[i]]
        style = ("-", "--", ":")[k // len(COLOURS) % 3]
        axes.plot(
            frame, scores[:, i], style, color=COLOURS[k % len(COLOURS)], linewidth=1, label=name
        )
    low = float(np.quantile(scores[:, templates], 0.01)) if templates else 0.0
    axes.set(ylim=(min(0.9, low), 1.02), xmargin=0)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=6, frameon=False)


def draw_controls(axes: Axes, performance: Performance) -> None:
    """The mean of each group of muscles that moves, jaw and lids."""
    frame = performance.frame
    for group, name in GROUPS.items():
        curve = performance.activations[:, performance.groups == group].mean(axis=1)
        if curve.max() > 0.02:
            axes.plot(frame, curve, color=GROUP_COLOURS[group], linewidth=1.1, label=name)
    for name, colour in (("jaw_open", INK), ("lid_upper.L", SOFT)):
        if name in performance.articulators:
            curve = performance.articulator_values[:, performance.articulators.index(name)]
            axes.plot(frame, curve, "--", color=colour, linewidth=1, label=name.replace("_", " "))
    axes.set(ylim=(-0.15, 1.02), xmargin=0)
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize=6, frameon=False)


def live_figure(
    taught: TaughtSet,
    performance: Performance,
    trace: Trace,
    mode: str,
    pictures: list[tuple[int, NDArray[np.uint8], NDArray[np.uint8]]],
) -> Figure:
    """Fig. 13: pictures of the camera, scores, muscle controls, the driven face.

    pictures: (frame, camera's picture, driven face) of each moment shown.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    groups = shown_templates(taught, mode)
    count = len(pictures)
    with rc_context({"font.size": 8, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(11, 4.6 + 1.1 * len(groups) + 1.6), layout="constrained")
        ratios = [2.0, *[1.0] * len(groups), 1.6, 2.0]
        grid = figure.add_gridspec(len(ratios), count, height_ratios=ratios)
        for k, (frame, camera, face) in enumerate(pictures):
            for row, picture in ((0, camera), (-1, face)):
                panel = figure.add_subplot(grid[row, k])
                panel.imshow(picture)
                panel.axis("off")
                if row == 0:
                    panel.set_title(f"frame {frame}", fontsize=7)
        for row, (title, templates) in enumerate(groups.items(), 1):
            panel = figure.add_subplot(grid[row, :])
            draw_scores(panel, taught, trace, templates, performance.frame)
            panel.set_title(f"scores, {title}", loc="left", fontsize=7)
            _mark(panel, pictures)
        panel = figure.add_subplot(grid[len(groups) + 1, :])
        draw_controls(panel, performance)
        panel.set_title("muscle controls", loc="left", fontsize=7)
        panel.set_xlabel("frame")
        _mark(panel, pictures)
    return figure


def _mark(axes: Axes, pictures: list) -> None:
    for frame, *_ in pictures:
        axes.axvline(frame, color=SOFT, linewidth=0.6, linestyle=":")
