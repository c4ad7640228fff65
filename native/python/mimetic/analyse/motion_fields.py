# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's Fig. 6: motion fields of an expression, as flow in the picture and as the surface's
motion there and in space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.analyse.comparison import Comparison
from mimetic.analyse.comparison_figures import HIGHEST, LOWEST, draw_head
from mimetic.analyse.drawing import INK, new_figure
from mimetic.media.backward import frames_away
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.score.luminance import GREY
from mimetic.score.sampling import sampled
from mimetic.template.face_template import FaceTemplate

if TYPE_CHECKING:
    from matplotlib.figure import Figure

APART = 0.010  # metres between arrows' feet, about
SPACE_SCALE = 2.0  # that motion in space is drawn enlarged by
MARGIN = 0.15  # of the face's size, about it in the pictures


@dataclass(frozen=True)
class MotionFields:
    """Motion of P points of the skin from an event's frame at rest to its peak."""

    image: NDArray[np.uint8]  # H x W x 3, the frame at rest
    rest: int  # frame numbers; the peak's may be the lower one
    peak: int
    vertices: NDArray[np.int64]  # P
    pixels: NDArray[np.float64]  # P x 2, in the frame at rest
    flow: NDArray[np.float64]  # P x 2, pixels, frame by frame along the optical flow
    of_surface: NDArray[np.float64]  # P x 2, pixels, as the performance has it, head and skin
    in_space: NDArray[np.float64]  # P x 3, metres, head frame: of the skin alone


def motion_fields(comparison: Comparison, template: FaceTemplate, footage: Footage) -> MotionFields:
    """Fields of a comparison's event; raises InvalidInput where the footage is another's size."""
    performance, rows = comparison.performance, comparison.rows
    if tuple(footage.size) != tuple(int(side) for side in performance.image_size):
        raise InvalidInput(
            f"--footage has pictures of {footage.size[0]} x {footage.size[1]}, the performance of "
            "{} x {}: give the clip that was captured".format(*performance.image_size)
        )
    rest, peak = int(rows[comparison.rest]), int(rows[comparison.peak])
    vertices = _feet(performance, rest, template, comparison.areas > 0)
    start, end = (
        performance.project(performance.surface_in_camera(i)[vertices]) for i in (rest, peak)
    )
    images = _images(footage, int(performance.frame[rest]), int(performance.frame[peak]))
    image = next(images)
    return MotionFields(
        *(image, int(performance.frame[rest]), int(performance.frame[peak]), vertices, start),
        _followed(image, images, start) - start,
        end - start,
        comparison.seen[vertices],
    )


def _images(footage: Footage, rest: int, peak: int) -> Iterator[NDArray[np.uint8]]:
    """From one frame to the other, whichever comes first."""
    step = 1 if peak >= rest else -1
    numbers = []
    for number, image in frames_away(footage, rest - step, peak):
        numbers.append(number)
        yield image
    if numbers != list(range(rest, peak + step, step)):
        last = max(rest, peak)
        raise InvalidInput(f"--footage ends before frame {last}: give the clip that was captured")


def _followed(
    image: NDArray[np.uint8], images: Iterator[NDArray[np.uint8]], start: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Where pixels (P x 2) are in the last image, each step along the flow."""
    before, places = _grey(image), start
    for after in map(_grey, images):
        places = places + sampled(np.asarray(_core.compute_flow(before, after).flow), places)
        before = after
    return places


def _grey(image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.ascontiguousarray(np.rint(image @ GREY).astype(np.uint8))


def _feet(
    performance: Performance, i: int, template: FaceTemplate, is_face: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Vertices of the face that the camera sees, one in each cube of APART."""
    in_camera = performance.surface_in_camera(i) * [1, -1, -1]  # up and towards the viewer
    quads = template.skin_faces[_core.faces_in_view(in_camera, template.skin_faces).faces]
    visible_vertices = np.unique(quads[is_face[quads].all(axis=1)])
    cells = np.floor(performance.neutral_vertices[visible_vertices] / APART).astype(int)
    _, indices = np.unique(cells, axis=0, return_index=True)
    return visible_vertices[np.sort(indices)]


def motion_figure(fields: MotionFields, comparison: Comparison, template: FaceTemplate) -> Figure:
    """Flow over the picture, the surface's motion over it, and the skin's motion in space."""
    figure, axes = new_figure(1, 3, (7.2, 3.4), sharex=False)
    low, high = fields.pixels.min(axis=0), fields.pixels.max(axis=0)
    about = MARGIN * (high - low).max()
    for panel, field, title in (
        (axes[0, 0], fields.flow, "(a) optical flow"),
        (axes[0, 1], fields.of_surface, "(b) surface, in the picture"),
    ):
        panel.imshow(fields.image, interpolation="bilinear")
        panel.quiver(
            *fields.pixels.T, *field.T,
            angles="xy", scale_units="xy", scale=1, color="#ffd23f", width=0.006,
            headwidth=3.5, headlength=4, minlength=0.5,
        )  # fmt: skip
        panel.set(xlim=(low[0] - about, high[0] + about), ylim=(high[1] + about, low[1] - about))
        panel.set_axis_off()
        panel.set_title(title, fontsize=9, color=INK)
    panel = axes[0, 2]
    neutral = comparison.performance.neutral_vertices
    draw_head(panel, neutral, template, None)
    feet, field = neutral[fields.vertices], SPACE_SCALE * fields.in_space
    lengths = 1000 * np.sqrt((fields.in_space**2).sum(axis=1))
    arrows = panel.quiver(
        *feet[:, :2].T, *field[:, :2].T, lengths,
        angles="xy", scale_units="xy", scale=1, cmap="viridis", width=0.006,
        headwidth=3.5, headlength=4, minlength=0.5,
    )  # fmt: skip
    panel.set(ylim=(LOWEST, HIGHEST))
    panel.set_title(f"(c) skin in space, {SPACE_SCALE:g} x", fontsize=9, color=INK)
    bar = figure.colorbar(arrows, ax=panel, orientation="horizontal", shrink=0.8, pad=0.02)
    bar.set_label("mm", fontsize=7)
    bar.ax.tick_params(labelsize=7)
    return figure


COLUMNS = ["vertex", "x", "y", "flow_x", "flow_y", "surface_x", "surface_y"]
COLUMNS += ["space_x_mm", "space_y_mm", "space_z_mm"]


def motion_rows(fields: MotionFields) -> Iterator[dict[str, object]]:
    """A row for each point: pixels of the first frame, millimetres of the head frame."""
    table = np.column_stack([fields.pixels, fields.flow, fields.of_surface, 1000 * fields.in_space])
    for vertex, row in zip(fields.vertices.tolist(), table.tolist(), strict=True):
        yield dict(zip(COLUMNS, [vertex, *row], strict=True))
