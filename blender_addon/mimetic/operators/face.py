# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import BoolProperty, IntProperty
from bpy.types import Operator

from .. import native, scene_in, scene_out
from ..jobs import Job


class MIMETIC_OT_find_face(Job, Operator):
    """Find the face in the footage, and fit head shape, pose and camera to it"""

    bl_idname = "mimetic.find_face"
    bl_label = "Find Face"
    bl_options = {"UNDO"}

    frame: IntProperty(
        name="Frame", min=0, description="Footage frame to look in; 0 takes the first with a face"
    )
    use_shown_frame: BoolProperty(
        name="Shown Frame", description="Look in the frame that the clip editor shows"
    )

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_clip(context):
            cls.poll_message_set(reason)
        return not reason

    def read(self, context):
        frame = scene_in.shown_frame(context) if self.use_shown_frame else self.frame
        return scene_in.footage(context), frame or None

    def work(self, inputs, progress):
        footage, frame = inputs
        pipeline = native.part("pipeline")
        return footage.clip_name, pipeline.find_face(footage.path, frame, progress=progress)

    def write(self, context, result):
        clip_name, fit = result
        scene_out.face_fit.store(context.scene, bpy.data.movieclips[clip_name], fit)
        return f"Face found in frame {fit.frame}; drag its landmarks in the clip editor to pin them"
