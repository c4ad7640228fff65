# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.types import Operator

from .. import native
from .following import Following


class MIMETIC_OT_capture(Following, Operator):
    """Follow the head and solve the muscles through the clip; stopping keeps what is done"""

    bl_idname = "mimetic.capture"
    bl_label = "Capture"
    message = "Captured frames {first} to {last}"

    @staticmethod
    def follow(option, footage_path, frames, fit, progress):
        return native.clip_capture().capture(
            footage_path, frames=frames, fit=fit, progress=progress
        )
