# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Figs. 7, 8 and 9: an expression beside its action unit, drawn for print."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.analyse.comparison import SIGNIFICANT, Comparison
from mimetic.analyse.drawing import INK, SOFT, new_figure
from mimetic.template.face_template import FaceTemplate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SKIN = np.array([0.87, 0.78, 0.72])
GREY = np.array([0.80, 0.81, 0.82])
LOWEST, HIGHEST = -0.105, 0.115  # metres of the head that are drawn
# Left out of Fig. 8: they hardly move, or lie beyond the face
NO_CONTROL_POINTS = ("tragus", "gonion", "hairline")


def neutral_figure(comparison: Comparison, template: FaceTemplate) -> Figure:
    """Neutral, action unit and video, shaded and as wireframe (Fig. 7)."""
    neutral = comparison.performance.neutral_vertices
    figure, axes = new_figure(2, 3, (7.2, 6.4), sharex=False)
    titles = ("(a) neutral", f"(b) {comparison.unit.name} of FACS", "(c) video")
    offsets = (0 * neutral, comparison.by_unit, comparison.seen)
    for column, (title, offset) in enumerate(zip(titles, offsets, strict=True)):
        for row, style in enumerate(("shaded", "wire")):
            panel = axes[row, column]
            draw_head(panel, neutral + offset, template, None, is_wire=style == "wire")
            if row == 0:
                panel.set_title(title, fontsize=9, color=INK)
    return figure


def course_figure(comparison: Comparison, template: FaceTemplate) -> Figure:
    """Displacement of control points over time: the unit by a ramp above, video below (Fig. 8)."""
    from matplotlib.figure import Figure

    names, lengths_seen, lengths_unit = control_points(comparison, template)
    frames = comparison.performance.frame[comparison.rows]
    figure = Figure(figsize=(7.2, 8.4), layout="constrained")
    top = 1.05 * max(float(lengths_seen.max()), float(lengths_unit.max()), 0.5)
    labels = (f"{comparison.unit.name} of FACS, linear ramp", "observed in video")
    for row, (lengths, label) in enumerate(zip((lengths_unit, lengths_seen), labels, strict=True)):
        panel: Any = figure.add_subplot(2, 1, row + 1, projection="3d")
        grid = np.meshgrid(frames, np.arange(len(names)))
        panel.plot_surface(
            *grid, lengths, cmap="viridis", vmin=0, vmax=top, rstride=1, cstride=1, lw=0.15,
            edgecolor="#ffffff60", antialiased=True,
        )  # fmt: skip
        panel.set(zlim=(0, top))
        panel.set_title(label, fontsize=9, color=INK)
        panel.set_xlabel("frame", fontsize=8)
        panel.set_zlabel("mm", fontsize=8)
        step = 3
        panel.set_yticks(range(0, len(names), step), names[::step], fontsize=5.5, ha="left")
        panel.tick_params(labelsize=6.5, pad=0)
        panel.tick_params(axis="y", labelsize=5.5, pad=-2)
        panel.view_init(32, -62)
        panel.set_box_aspect((1.5, 1.3, 0.65), zoom=1.2)
    return figure


def difference_figure(comparison: Comparison, template: FaceTemplate) -> Figure:
    """How far skin moves by the unit and in the video, and the difference (Fig. 9)."""
    neutral = comparison.performance.neutral_vertices
    by_unit, in_video, excess = motion_lengths(comparison)
    is_certain = np.abs(excess) > 1000 * comparison.stds * SIGNIFICANT
    top = max(float(in_video.max()), float(by_unit.max()), 0.5)
    widest = max(float(np.abs(excess[is_certain]).max(initial=0.0)), 0.5)
    figure, axes = new_figure(1, 3, (7.2, 4.0), sharex=False)
    columns = (
        (f"(a) {comparison.unit.name} of FACS", by_unit, comparison.by_unit, "viridis", 0, top),
        ("(b) video", in_video, comparison.seen, "viridis", 0, top),
        ("(c) video less FACS", excess, comparison.seen, "coolwarm", -widest, widest),
    )
    for column, (title, values, offset, colours, low, high) in enumerate(columns):
        panel = axes[0, column]
        mask = is_certain if column == 2 else None
        colouring = (values, colours, low, high, mask)
        draw_head(panel, neutral + offset, template, colouring, areas=comparison.areas)
        panel.set_title(title, fontsize=9, color=INK)
        _colour_bar(figure, panel, colours, low, high)
    return figure


def motion_lengths(
    comparison: Comparison,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """V each, millimetres: motion by the unit, observed motion, and the difference."""
    by_unit = 1000 * np.sqrt((comparison.by_unit**2).sum(axis=1))
    in_video = 1000 * np.sqrt((comparison.seen**2).sum(axis=1))
    return by_unit, in_video, in_video - by_unit


def control_points(
    comparison: Comparison, template: FaceTemplate
) -> tuple[list[str], NDArray[np.float64], NDArray[np.float64]]:
    """Names (K) of landmarks from the brow down, and their displacements (K x N each, mm).

    The first as observed; the second by the unit, its intensity a straight ramp up and down.
    """
    places = [
        (name, int(vertex))
        for name, vertex in zip(template.landmark_names, template.landmark_vertices, strict=True)
        if name.split(".")[0] not in NO_CONTROL_POINTS
    ]
    neutral = comparison.performance.neutral_vertices
    places.sort(key=lambda place: -neutral[place[1], 1])
    vertices = [vertex for _, vertex in places]
    in_video = 1000 * np.sqrt((comparison.displacements[:, vertices] ** 2).sum(axis=2)).T
    unit = 1000 * np.sqrt((comparison.by_unit[vertices] ** 2).sum(axis=1))
    ramp = comparison.ramp / max(1e-9, float(comparison.ramp.max()))
    return [name for name, _ in places], in_video, unit[:, None] * ramp


def draw_head(
    panel: Axes,
    vertices: NDArray[np.float64],
    template: FaceTemplate,
    colouring: tuple | None,
    is_wire: bool = False,
    areas: NDArray[np.float64] | None = None,
) -> None:
    """The skin seen from the front.

    colouring: values, colour map, lowest, highest, mask or None.
    """
    from matplotlib import colormaps
    from matplotlib.collections import PolyCollection

    faces = template.skin_faces
    view = _core.faces_in_view(vertices, faces)
    quads = faces[view.faces]
    corners = vertices[quads][:, :, :2]
    shades = np.asarray(view.shades)[:, None]
    colours = np.tile(SKIN if colouring is None else GREY, (len(quads), 1))
    if colouring is not None:
        values, name, low, high, mask = colouring
        share = (values[quads].mean(axis=1) - low) / (high - low)
        is_drawn = np.ones(len(quads), bool) if areas is None else (areas[quads] > 0).all(axis=1)
        if mask is not None:
            is_drawn &= mask[quads].mean(axis=1) >= 0.5
        colours[is_drawn] = colormaps[name](share[is_drawn])[:, :3]
        shades = 0.6 + 0.4 * shades
    if is_wire:
        collection = PolyCollection(corners, facecolors="white", edgecolors=INK, linewidths=0.15)
    else:
        face_colours = np.clip(colours * shades, 0, 1)
        collection = PolyCollection(
            corners, facecolors=face_colours, edgecolors=face_colours, linewidths=0.3
        )
    collection.set_rasterized(True)
    panel.add_collection(collection)
    panel.set(xlim=(-0.085, 0.085), ylim=(LOWEST, HIGHEST), aspect="equal")
    panel.set_axis_off()


def _colour_bar(figure: Figure, panel: Axes, colours: str, low: float, high: float) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    scale = ScalarMappable(Normalize(low, high), colours)
    bar = figure.colorbar(scale, ax=panel, orientation="horizontal", shrink=0.8, pad=0.02)
    bar.set_label("mm" if low == 0 else "mm; grey: within two standard deviations", fontsize=7)
    bar.ax.tick_params(labelsize=7, color=SOFT)
    bar.outline.set_visible(False)
