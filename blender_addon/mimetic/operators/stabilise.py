# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import FloatProperty
from bpy.types import Operator

from .. import clips, native, outcome, plural, scene_in, scene_out, takes, writable
from ..greyed import Greyed
from ..jobs import Job
from . import arguments


class MIMETIC_OT_hold_head_still(Job, Operator):
    """Stabilise the clip's view on the head, so that only the face moves; no file is changed"""

    bl_idname = "mimetic.hold_head_still"
    bl_label = "Hold Head Still"
    bl_options = {"REGISTER", "UNDO"}

    smoothing: FloatProperty(
        name="Smoothing",
        min=0.0,
        options=arguments.OF_ONE_CALL,
        description="Strength of smoothing, in the poses' own standard deviations; not given: as "
        "the panel Head has it",
    )

    obstacle = staticmethod(scene_in.no_stabilising)
    needs_object_mode = False

    def read(self, context):
        smoothing = arguments.chosen(self, "smoothing", context.scene.mimetic.head)
        return scene_in.take(context), smoothing

    def work(self, inputs, progress):
        take, smoothing = inputs
        performance = takes.load(take)
        if not progress(0.2, "smoothing"):
            return None
        return native.head_smoothing().smoothed(performance, smoothing), take.clip_name

    def write(self, context, result):
        performance, clip_name = result
        clip = clips.named(clip_name)
        num_frames = scene_out.stabilised.hold_still(clip, performance)
        self.facts = {"clip": clip_name, "num_frames": num_frames}
        return plural.one_or_many(
            num_frames,
            rpt_("The head is held still in 1 frame of {clip}"),
            rpt_("The head is held still in {count} frames of {clip}"),
        ).format(count=num_frames, clip=clip.name)


class MIMETIC_OT_release_head(Greyed, Operator):
    """Show the clip as it was filmed again"""

    bl_idname = "mimetic.release_head"
    bl_label = "Release Head"
    bl_options = {"UNDO"}  # once released there is nothing to redo

    @classmethod
    def obstacle(cls, context):
        reason = scene_in.no_clip(context)
        if not reason and not scene_in.is_held(scene_in.clip_of(context)):
            reason = "The clip is shown as it was filmed"
        reason = reason or writable.no_tracks(scene_in.clip_of(context))
        return reason

    def execute(self, context):
        clip = scene_in.clip_of(context)
        scene_out.stabilised.release(clip)
        return outcome.finished(self, context, "", clip=clip.name)


CLASSES = (MIMETIC_OT_hold_head_still, MIMETIC_OT_release_head)
