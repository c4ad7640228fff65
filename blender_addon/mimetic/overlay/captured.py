# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a captured take over its footage in the clip editor: surface, lids and lips, irises,
landmarks, and the quality of each frame."""

from __future__ import annotations

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import corrections, native, scene_in
from . import picture, quality, seen, text

MESH, FEATURES, IRISES = (0.15, 1.0, 0.45, 0.2), (1.0, 0.75, 0.1, 0.95), (0.2, 0.75, 1.0, 0.95)
LANDMARKS, LANDMARK_SIZE = (1.0, 0.2, 0.6, 0.95), 4.0
CAPTURED = (MESH, FEATURES, IRISES, LANDMARKS)
STATED_MESH, STATED = (1.0, 1.0, 1.0, 0.12), (1.0, 1.0, 1.0, 0.95)  # by corrections
PIN_SIZE = 7.0
STRIP_BOTTOM, STRIP_HEIGHT = 22, 6  # pixels at a UI scale of 1, above Blender's own strips


def draw_capture(context) -> bool:
    """Returns whether the frame on show has a captured face: a fitted one would lie beneath."""
    settings = context.scene.mimetic
    if not settings.show_capture and not settings.show_quality:
        return False
    frame = scene_in.shown_frame(context)
    shown = at_work = seen.of_work(context)
    # What the run has not come to yet is as the take before has it
    if at_work is None or at_work.row_of(frame) is None:
        shown = seen.of_take(context) or at_work
    if shown is None:
        return False
    row = shown.row_of(frame) if settings.show_capture else None
    gpu.state.blend_set("ALPHA")
    try:
        if row is not None:
            _draw_face(context, shown, row, settings)
        if settings.show_quality:
            _draw_quality(context, at_work or shown, frame)
    finally:
        gpu.state.point_size_set(1.0)
        gpu.state.blend_set("NONE")
    return row is not None


def _draw_face(context, shown: seen.Seen, row: int, settings) -> None:
    if shown.drawn is None or shown.drawn[0] != row:
        shown.drawn = (row, *_batches(shown.lines.draw(row)))
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    scale = context.preferences.system.pixel_size
    gpu.state.point_size_set(LANDMARK_SIZE * scale)
    with gpu.matrix.push_pop():
        picture.lay_over(context.region.view2d)
        _draw_batches(shader, shown.drawn[1:], CAPTURED, settings)
        if shown.performance is not None:  # takes are corrected
            _draw_corrections(context, shader, shown, row, settings)


def _batches(lines) -> tuple:
    marks = lines.marks[np.array(lines.marks_shown, dtype=bool)]
    return (*_line_batches(lines), _batch(marks, "POINTS"))


def _line_batches(lines) -> tuple:
    return tuple(_batch(part, "LINES") for part in (lines.mesh, lines.features, lines.rings))


def _draw_batches(shader, batches: tuple, colours: tuple, settings) -> None:
    is_on = (
        settings.show_capture_mesh,
        settings.show_capture_features,
        settings.show_capture_features,
        settings.show_capture_landmarks,
    )
    for batch, colour, is_shown in zip(batches, colours, is_on, strict=False):
        if is_shown and batch is not None:
            shader.uniform_float("color", colour)
            batch.draw(shader)


def _draw_corrections(context, shader, shown: seen.Seen, row: int, settings) -> None:
    """The face as values and pose are stated, in white over the captured one; pins."""
    entries = corrections.readable(context.edit_movieclip)
    correcting = native.correcting()
    entry = correcting.at_frame(entries, scene_in.shown_frame(context))
    if entry is None:
        return
    if correcting.states_more_than_pins(entry):
        if shown.stated is None or shown.stated[0] != row or shown.stated[1] is not entry:
            shown.stated = (row, entry, *_line_batches(shown.lines.draw(row, entry)))
        _draw_batches(shader, shown.stated[2:], (STATED_MESH, STATED, STATED), settings)
    _draw_pins(context, shader, entries)


def _draw_pins(context, shader, entries: tuple) -> None:
    """Each from the skin's place as captured to the pixel where it belongs."""
    try:
        places = corrections.board(context).lines(entries, scene_in.shown_frame(context))
    except native.known_errors():  # of a capture with fewer frames
        return
    if len(places):
        shader.uniform_float("color", STATED)
        _batch(places, "LINES").draw(shader)
        gpu.state.point_size_set(PIN_SIZE * context.preferences.system.pixel_size)
        _batch(places[1::2], "POINTS").draw(shader)


def _batch(places, kind: str):
    if not len(places):
        return None
    # Blender takes an array's bytes as they are: of double precision nothing would be seen
    points = np.zeros((len(places), 3), dtype=np.float32)
    points[:, :2] = places
    return batch_for_shader(gpu.shader.from_builtin("UNIFORM_COLOR"), kind, {"pos": points})


def _draw_quality(context, shown: seen.Seen, frame: int) -> None:
    """Along the bottom, as Blender's own strips: the scene's range over the region's width."""
    scene, clip, region = context.scene, context.edit_movieclip, context.region
    scale = context.preferences.system.ui_scale
    per_frame = region.width / max(scene.frame_end - scene.frame_start + 1, 1)
    left = per_frame * (scene_in.scene_frame(clip, 1) - scene.frame_start)
    quality.draw(context, shown, left, per_frame, STRIP_BOTTOM * scale, STRIP_HEIGHT * scale)
    with text.style(scale):
        above = (STRIP_BOTTOM + STRIP_HEIGHT + 6) * scale
        text.write(quality.text_of(shown, frame), 10 * scale, above)
