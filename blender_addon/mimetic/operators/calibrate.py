# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.types import Operator

from .. import clips, native, scene_in, scene_out
from ..jobs import Job
from . import arguments


class MIMETIC_OT_calibrate(arguments.FrameRange, Job, Operator):
    """Learn from the clip, best a few seconds with every expression, how firmly this person's \
skin is held and how strong the muscles are; the fit keeps it for every capture"""

    bl_idname = "mimetic.calibrate"
    bl_label = "Calibrate"
    bl_options = {"UNDO"}

    obstacle = staticmethod(scene_in.no_fit)
    needs_object_mode = False

    @classmethod
    def subject(cls, context):
        return clips.name_of(scene_in.clip_of(context))

    def read(self, context):
        clip = scene_in.clip_of(context)
        frames = arguments.frame_range(self, context)
        most = native.calibration_run().MOST_FRAMES
        if frames is None and clip.frame_duration > most:
            raise native.invalid_input(
                rpt_(
                    "Calibration uses {most} frames at most: tick Part of the "
                    "Clip, and choose a few seconds in which the face moves"
                ).format(most=most)
            )
        return scene_in.footage(context), frames, scene_out.face_fit.of_clip(clip)

    def work(self, inputs, progress):
        footage, frames, fit = inputs
        try:
            calibrate = native.calibration_run().calibrate
            calibrated_fit, _ = calibrate(footage.path, frames, fit, progress)
        except KeyboardInterrupt:  # stopped: half a calibration is none
            return None
        return footage.clip_name, calibrated_fit

    def write(self, context, result):
        clip_name, fit = result
        scene_out.face_fit.keep(clips.named(clip_name), fit)
        self.facts = {"clip": clip_name, "frames": list(fit.calibration.frames)}
        return rpt_("Calibrated: {what}").format(what=fit.calibration.described())
