# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of captured frames: a strip of boxes in the clip editor and in the editors of time,
and the words for a frame."""

from __future__ import annotations

import gpu
from bpy.app.translations import pgettext_iface as iface_
from gpu_extras.batch import batch_for_shader

from .. import corrections, native, scene_in
from .seen import Seen


def draw(context, seen: Seen, left: float, per_frame: float, bottom: float, height: float) -> None:
    """left: of footage frame 1; per_frame: width of one; all in pixels of the region. Corrected
    frames have a second box above, as high."""
    corrected = tuple(corrections.frames_of(scene_in.clip_of(context)))
    frames, quality = seen.qualities()
    shader = gpu.shader.from_builtin("SMOOTH_COLOR")
    state = (corrected, len(frames))
    if seen.strip is None or seen.strip[0] != state:
        # Boxes of 1 by 1: the same wherever the view goes
        points, colours = native.face_lines().quality_strip(
            frames, quality, 0.0, 1.0, 0.0, 1.0, corrected
        )
        content = {"pos": points, "color": colours}
        seen.strip = (state, batch_for_shader(shader, "TRIS", content))
    with gpu.matrix.push_pop():
        gpu.matrix.translate((left, bottom))
        gpu.matrix.scale((per_frame, height))
        seen.strip[1].draw(shader)


def text_of(seen: Seen, frame: int) -> str:
    """What is known of a footage frame."""
    quality = seen.quality_of(frame)
    if quality is None:
        return iface_("not followed yet") if seen.performance is None else iface_("not captured")
    text = iface_("quality {quality:.2f}").format(quality=quality.value)
    text += iface_(", lost: held") if quality.is_held else ""
    return text + (iface_(", corrected") if quality.is_corrected else "")
