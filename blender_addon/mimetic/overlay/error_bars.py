# SPDX-License-Identifier: GPL-3.0-or-later
"""Bands about the selected curves of a baked face in the Graph Editor: how far they may be off."""

from __future__ import annotations

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import baked_errors, native
from . import text

OPACITY = 0.18
CONFOUNDED = (1.0, 0.55, 0.1, 0.35)
MARGIN, LINE, BELOW_NUMBERS = 48, 18, 50  # pixels at a UI scale of 1

# Of the curves that were drawn last: the error bars they are of, by name two batches
_batches: tuple | None = None


def draw_bands() -> None:
    context = bpy.context
    if native.problem() or not context.scene.mimetic.show_error_bars or no_values(context):
        return
    found = baked_errors.of_selected(context)
    if isinstance(found, str):
        return
    gpu.state.blend_set("ALPHA")
    try:
        for curve in found.curves:
            _draw_band(context, found, curve)
    finally:
        gpu.state.blend_set("NONE")
    _write_values(context, found)


def no_values(context) -> str:
    """Why an editor's height is not the curves' own values, or nothing."""
    space = context.space_data
    if space is None or space.type != "GRAPH_EDITOR":
        return ""
    if space.mode == "DRIVERS":
        return "Drivers have no error bars"
    if space.use_normalization and not space.use_auto_normalization:
        return "Switch Auto-Normalize on, beside Normalize: how curves are stretched is not known"
    return ""


def _stretch(context, curve: bpy.types.FCurve) -> tuple[float, float]:
    """What Blender adds to a curve's values, and then multiplies them by, as it draws them."""
    if not context.space_data.use_normalization:
        return 0.0, 1.0
    points = np.empty(2 * len(curve.keyframe_points), dtype=np.float32)
    curve.keyframe_points.foreach_get("co", points)
    frames, values = points[::2], points[1::2]
    scene = context.scene
    if scene.use_preview_range:
        is_shown = (frames >= scene.frame_preview_start) & (frames <= scene.frame_preview_end)
        frames, values = frames[is_shown], values[is_shown]
    if len(values) and any(key.interpolation == "BEZIER" for key in curve.keyframe_points):
        # Between keys it may go further than they do
        between = np.arange(np.ceil(frames[0]), frames[-1])
        values = np.append(values, [curve.evaluate(frame) for frame in between])
    if not len(values) or values.min() == values.max():
        return (-float(values[0]), 1.0) if len(values) else (0.0, 1.0)
    low, high = float(values.min()), float(values.max())
    return -0.5 * (low + high), 2 / (high - low)


def _draw_band(context, found, curve) -> None:
    region = context.region
    left, bottom = region.view2d.region_to_view(0, 0)
    right, top = region.view2d.region_to_view(region.width, region.height)
    if right <= left or top <= bottom:
        return
    across, up = region.width / (right - left), region.height / (top - bottom)
    told_apart, confounded = _batches_of(found.bars, curve.shape)
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    begin = found.row.scene_first - found.step * found.row.first
    offset, factor = _stretch(context, curve.curve)
    with gpu.matrix.push_pop():
        gpu.matrix.translate(((begin - left) * across, (offset * factor - bottom) * up))
        gpu.matrix.scale((found.step * across, curve.unit * factor * up))
        for batch, colour in (
            (told_apart, (*curve.curve.color, OPACITY)),
            (confounded, CONFOUNDED),
        ):
            if batch is not None:
                shader.uniform_float("color", colour)
                batch.draw(shader)


def _batches_of(bars, name: str) -> tuple:
    global _batches
    if _batches is None or _batches[0] is not bars:
        _batches = (bars, {})
    made = _batches[1]
    if name not in made:
        shader, band = gpu.shader.from_builtin("UNIFORM_COLOR"), bars.band(name)
        made[name] = tuple(
            batch_for_shader(shader, "TRIS", {"pos": points}) if len(points) else None
            for points in (band.told_apart, band.confounded)
        )
    return made[name]


def _write_values(context, found) -> None:
    """The values at the playhead, in the upper left corner."""
    scale = context.preferences.system.ui_scale
    top = context.region.height - BELOW_NUMBERS * scale
    if top < LINE * len(found.curves) * scale:
        return  # they would lie on the markers
    frame = context.scene.frame_current_final
    with text.style(scale):
        for k, curve in enumerate(found.curves):
            line = baked_errors.line_of(found, curve, frame)
            text.write(line, MARGIN * scale, top - k * LINE * scale)


def forget() -> None:
    global _batches
    _batches = None
