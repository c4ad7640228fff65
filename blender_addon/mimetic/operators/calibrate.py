# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.types import Operator

from .. import native, scene_in, scene_out
from ..jobs import Job


class MIMETIC_OT_calibrate(Job, Operator):
    """Learn from the clip, best a few seconds with every expression, how firmly this person's \
skin is held and how strong the muscles are; the fit keeps it for every capture"""

    bl_idname = "mimetic.calibrate"
    bl_label = "Calibrate"
    bl_options = {"UNDO"}

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_fit(context):
            cls.poll_message_set(reason)
        return not reason

    def read(self, context):
        scene = context.scene
        frames = scene_in.frame_range(scene)
        most = native.part("calibration_capture").MOST_FRAMES
        if frames is None and scene_in.clip_of(context).frame_duration > most:
            raise native.invalid_input(
                f"Calibration rests on {most} frames at most: tick Part of the Clip, and choose a "
                "few seconds in which the face moves"
            )
        return scene_in.footage(context).path, frames, scene_out.face_fit.stored(scene)

    def work(self, inputs, progress):
        path, frames, fit = inputs
        try:
            return native.part("calibration_capture").calibrate(path, frames, fit, progress)
        except KeyboardInterrupt:  # stopped: half a calibration is none
            return None

    def write(self, context, result):
        fit, _ = result
        scene_out.face_fit.keep(context.scene, fit)
        return f"Calibrated: {fit.calibration.described()}"
