# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.props import StringProperty
from bpy.types import Operator

from .. import native, scene_in, scene_out, takes
from ..jobs import Job


class MIMETIC_OT_capture(Job, Operator):
    """Follow the head and solve the muscles through the clip; stopping keeps what is done"""

    bl_idname = "mimetic.capture"
    bl_label = "Capture"
    bl_options = {"UNDO"}

    filepath: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        description="File to write (.npz); empty: beside the .blend, a new one for each take",
    )

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_clip(context):
            cls.poll_message_set(reason)
        return not reason

    def read(self, context):
        footage = scene_in.footage(context)
        paths = (
            self.filepath or scene_in.capture_path(footage.clip_name),
            scene_in.spare_path(footage.clip_name),
        )
        fit = scene_out.face_fit.stored(context.scene)
        return footage.path, scene_in.frame_range(context.scene), fit, paths

    def work(self, inputs, progress):
        footage_path, frames, fit, (path, spare_path) = inputs
        performance = native.part("pipeline").capture(
            footage_path, frames=frames, fit=fit, progress=progress
        )
        first, last = performance.frame[0], performance.frame[-1]
        path, told = takes.save(performance, path, spare_path)
        return path, "; ".join([f"Captured frames {first} to {last}", *told])

    def write(self, context, result):
        path, told = result
        context.scene.mimetic.performance_path = path
        return told
