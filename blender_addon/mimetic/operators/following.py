# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.props import StringProperty

from .. import scene_in, scene_out, takes
from ..jobs import Job


class Following(Job):
    """Mixin of operators that make a performance from the clip; stopping keeps what is done.

    Subclasses give `follow(option, footage_path, frames, fit, progress)`, which runs without bpy
    and returns the performance, and may give `option(context)`.
    """

    bl_options = {"UNDO"}
    keeps_part = True
    told = "{first} to {last}"

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

    def option(self, context):
        return None

    def read(self, context):
        footage = scene_in.footage(context)
        paths = (
            self.filepath or scene_in.capture_path(footage.clip_name),
            scene_in.spare_path(footage.clip_name),
        )
        fit = scene_out.face_fit.stored(context.scene)
        return footage.path, scene_in.frame_range(context.scene), fit, paths, self.option(context)

    def work(self, inputs, progress):
        footage_path, frames, fit, paths, option = inputs
        performance = self.follow(option, footage_path, frames, fit, progress)
        path, remarks = takes.save(performance, *paths)
        told = self.told.format(first=performance.frame[0], last=performance.frame[-1])
        return path, "; ".join([told, *remarks])

    def write(self, context, result):
        path, told = result
        context.scene.mimetic.performance_path = path
        return told
