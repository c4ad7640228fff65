# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.types import Operator

from .. import clip_time, outcome, scene_in
from ..greyed import Greyed


class MIMETIC_OT_scene_as_clip(Greyed, Operator):
    """Give the scene the clip's rate and range: the clip editor and the face show the same frame.
    Curves that are there keep their frames"""

    bl_idname = "mimetic.scene_as_clip"
    bl_label = "Scene as Clip"
    bl_options = {"UNDO"}  # once they play alike there is nothing to redo

    @classmethod
    def obstacle(cls, context):
        reason = scene_in.no_clip(context)
        clip = scene_in.clip_of(context)
        if not reason and not clip_time.is_known(clip):
            reason = iface_("The rate of {clip} cannot be read: its file is not there").format(
                clip=clip.name
            )
        scene = context.scene
        if not reason and clip_time.has_rate(scene, clip) and clip_time.has_range(scene, clip):
            reason = "The scene has the clip's rate and range"
        return reason

    def execute(self, context):
        scene, clip = context.scene, scene_in.clip_of(context)
        had_rate = clip_time.has_rate(scene, clip)
        clip_time.apply(scene, clip)
        rate = scene.render.fps / scene.render.fps_base
        message = rpt_("{rate:.6g} frames/s, frames {first} to {last}").format(
            rate=rate, first=scene.frame_start, last=scene.frame_end
        )
        if not had_rate:
            message += rpt_("; what was baked keeps its frames: bake it again")
        frames = [scene.frame_start, scene.frame_end]
        return outcome.finished(self, context, message, fps=rate, scene_frames=frames)
