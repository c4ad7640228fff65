# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the fitted face's mesh over its frames in the clip editor."""

from __future__ import annotations

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .. import native, scene_in
from ..scene_out import face_fit
from . import picture

COLOUR = (0.1, 0.9, 1.0, 0.3)

_last: tuple[object, int, object] | None = None  # fit, frame, batch


def draw_fit(context) -> None:
    settings = context.scene.mimetic
    if not settings.show_fit:
        return
    batch = _batch(context)
    if batch is None:
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    gpu.state.blend_set("ALPHA")
    gpu.state.line_width_set(1.0)
    try:
        with gpu.matrix.push_pop():
            picture.lay_over(context.region.view2d)
            shader.uniform_float("color", COLOUR)
            batch.draw(shader)
    finally:
        gpu.state.blend_set("NONE")


def _batch(context):
    global _last
    try:
        fit = face_fit.of_clip(context.edit_movieclip)
    except native.known_errors():  # its JSON was edited and is no fit; the buttons say so
        return None
    if fit is None:
        return None
    frame = scene_in.shown_frame(context)
    if _last is None or _last[0] is not fit or _last[1] != frame:
        lines = native.fitted_lines().fit_lines(fit, frame).reshape(-1, 2)
        places = np.column_stack([lines, np.zeros(len(lines))]).astype(np.float32)
        shader = gpu.shader.from_builtin("UNIFORM_COLOR")
        batch = batch_for_shader(shader, "LINES", {"pos": places}) if len(lines) else None
        _last = (fit, frame, batch)
    return _last[2]


def forget() -> None:
    global _last
    _last = None
