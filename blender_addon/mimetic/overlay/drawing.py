# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what `mimetic.live_face` gives in the 3D view: lines, insertions, strain, a legend."""

from __future__ import annotations

import blf
import bpy
import gpu
from bpy.app.translations import pgettext_iface as iface_
from gpu_extras.batch import batch_for_shader

from .. import native
from . import live, text

HIDDEN_OPACITY = 0.14  # of lines behind something
LEGEND_SIZE = (260, 12)  # pixels at a UI scale of 1
MARGIN = 24


def draw_faces() -> None:
    context = bpy.context
    settings = context.scene.mimetic
    if not _is_on(context):
        return
    gpu.state.blend_set("ALPHA")
    gpu.state.depth_mask_set(False)
    try:
        for face in live.faces(context):
            view = live.look(face)
            if view.face is None:
                continue
            with gpu.matrix.push_pop():
                gpu.matrix.multiply_matrix(face.matrix_world)
                if settings.show_strain:
                    _draw_strain(view, settings)
                if settings.show_muscles:
                    _draw_muscles(view)
    finally:  # the next one to draw finds what it expects
        gpu.state.depth_mask_set(True)
        gpu.state.depth_test_set("NONE")
        gpu.state.face_culling_set("NONE")
        gpu.state.blend_set("NONE")


def draw_legend() -> None:
    context = bpy.context
    settings = context.scene.mimetic
    if not settings.show_strain or not _is_on(context):
        return
    ranges = [
        _strain(view, settings)[1]
        for view in map(live.look, live.faces(context))
        if view.face is not None
    ]
    if ranges:
        lowest, highest = min(r[0] for r in ranges), max(r[1] for r in ranges)
        _draw_scale(context, settings, lowest, highest)


def _is_on(context) -> bool:
    settings = context.scene.mimetic
    return context.space_data.overlay.show_overlays and (
        settings.show_muscles or settings.show_strain
    )


def _strain(view, settings):
    """The strain at the skin's vertices, its range, and its scale's end."""
    key = ("strain", settings.strain_measure)
    if key not in view.drawings:
        strain = view.face.strain(view.pose, settings.strain_measure.lower())
        view.drawings[key] = strain, view.face.strain_range(strain)
    return view.drawings[key]


def _draw_strain(view, settings) -> None:
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    key = ("patch", settings.strain_measure, settings.strain_limit)
    if key not in view.drawings:
        strain, _ = _strain(view, settings)
        patch = view.face.strain_patch(view.pose, strain, settings.strain_limit / 100)
        view.drawings[key] = _patch(shader, patch)
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.face_culling_set("BACK")
    view.drawings[key].draw(shader)
    gpu.state.face_culling_set("NONE")


def _draw_muscles(view) -> None:
    lines = gpu.shader.from_builtin("POLYLINE_SMOOTH_COLOR")
    if "lines" not in view.drawings:
        strokes = view.face.strokes(view.pose)
        view.drawings["lines"] = [
            (stroke.width, _lines(lines, stroke, 1.0), _lines(lines, stroke, HIDDEN_OPACITY))
            for stroke in strokes
        ]
    solid = gpu.shader.from_builtin("SMOOTH_COLOR")
    if "nodes" not in view.drawings:
        view.drawings["nodes"] = _patch(solid, view.face.nodes(view.pose))
    scale = bpy.context.preferences.system.pixel_size
    lines.bind()
    lines.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    for width, seen_lines, hidden_lines in view.drawings["lines"]:
        lines.uniform_float("lineWidth", width * scale)
        gpu.state.depth_test_set("NONE")
        hidden_lines.draw(lines)
        gpu.state.depth_test_set("LESS_EQUAL")
        seen_lines.draw(lines)
    gpu.state.depth_test_set("LESS_EQUAL")
    view.drawings["nodes"].draw(solid)


def _lines(shader, stroke, opacity: float):
    colours = stroke.colours.copy()
    colours[:, 3] *= opacity
    return batch_for_shader(shader, "LINES", {"pos": stroke.points, "color": colours})


def _patch(shader, patch):
    content = {"pos": patch.points, "color": patch.colours}
    return batch_for_shader(shader, "TRIS", content, indices=patch.triangles)


def _draw_scale(context, settings, lowest: float, highest: float) -> None:
    ui_scale = context.preferences.system.ui_scale
    width, height = (side * ui_scale for side in LEGEND_SIZE)
    room = context.region.width - 2 * MARGIN * ui_scale
    is_narrow, width = room < width, max(min(width, room), 1.0)
    left = (context.region.width - width) / 2
    bottom = MARGIN * ui_scale
    points, colours = native.strain_map().scale_strip(left, bottom, width, height)
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    gpu.state.blend_set("ALPHA")
    batch_for_shader(shader, "TRI_STRIP", {"pos": points, "color": colours}).draw(shader)
    gpu.state.blend_set("NONE")
    measure = settings.bl_rna.properties["strain_measure"].enum_items[settings.strain_measure].name
    title = iface_("Skin strain, {measure}: {lowest:+.1f} to {highest:+.1f} %").format(
        measure=iface_(measure).lower(), lowest=100 * lowest, highest=100 * highest
    )
    with text.style(ui_scale):
        for share in (0, 0.5, 1) if is_narrow else (0, 0.25, 0.5, 0.75, 1):
            mark = f"{(2 * share - 1) * settings.strain_limit:+.3g} %" if share != 0.5 else "0"
            wide, high = blf.dimensions(0, mark)
            text.write(mark, left + share * width - wide / 2, bottom - high - 4 * ui_scale)
        wide, _ = blf.dimensions(0, title)
        # Where there is no room for all of it its beginning says what is shown
        beginning = max(left + (width - wide) / 2, 4 * ui_scale)
        text.write(title, beginning, bottom + height + 6 * ui_scale)
