# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.types import Operator

from .. import corrections, native, scene_in
from .following import Following


class MIMETIC_OT_capture(Following, Operator):
    """Follow the head and solve the muscles through the clip; stopping keeps what is done"""

    bl_idname = "mimetic.capture"
    bl_label = "Capture"
    message = "Captured frames {first} to {last}"

    def option(self, context):
        return corrections.of_clip(scene_in.clip_of(context))

    @staticmethod
    def follow(option, footage_path, frames, fit, progress):
        first, last = frames or (None, None)
        within = tuple(c for c in option if (first or 1) <= c.frame <= (last or c.frame))
        return native.clip_capture().capture(
            footage_path, frames=frames, fit=fit, progress=progress, corrections=within
        )
