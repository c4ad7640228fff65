# SPDX-License-Identifier: GPL-3.0-or-later
"""The head alone: following it, and putting its motion on characters."""

import bpy
from bpy.props import EnumProperty
from bpy.types import Operator

from .. import native, scene_in, scene_out, takes, targets
from ..jobs import Job
from .following import Following

MODELS = (
    ("SURFACE", "Surface", "The person's fitted surface: the most accurate"),
    ("ELLIPSOID", "Ellipsoid", "An ellipsoid around the head"),
    ("PLANE", "Plane", "A planar patch on the face; loses heads that turn far"),
)


class MIMETIC_OT_track_head(Following, Operator):
    """Follow the head through the clip without its muscles; stopping keeps what is done"""

    bl_idname = "mimetic.track_head"
    bl_label = "Track Head"
    message = "Followed the head from frame {first} to {last}"

    model: EnumProperty(name="Model", items=MODELS, description="Model of the head")

    def option(self, context):
        return self.model.lower()

    @staticmethod
    def follow(option, footage_path, frames, fit, progress):
        return native.head_tracking().track_head(footage_path, option, frames, fit, progress)


class MIMETIC_OT_find_head_bones(Operator):
    """Choose the armature's head and neck by their usual names, as in Rigify's rigs"""

    bl_idname = "mimetic.find_head_bones"
    bl_label = "Find Head Bones"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        target = context.scene.mimetic.head.target
        reason = scene_in.no_start()
        if not reason and (target is None or target.type != "ARMATURE"):
            reason = "Choose an armature as the target first"
        if reason:
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context):
        settings = context.scene.mimetic.head
        bones = scene_out.rigs.head_bones(settings.target)
        if not bones.head:
            self.report({"ERROR"}, bones.remark)
            return {"CANCELLED"}
        settings.bone, settings.neck = bones.head, bones.neck
        self.report({"INFO"}, f"Head {bones.head}, neck {bones.neck or 'none'}")
        return {"FINISHED"}


class MIMETIC_OT_set_rest_frame(Operator):
    """Take the frame on show as the one in which actor and character hold their heads alike"""

    bl_idname = "mimetic.set_rest_frame"
    bl_label = "Rest at Shown Frame"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if reason := scene_in.no_clip(context):
            cls.poll_message_set(reason)
        return not reason

    def execute(self, context):
        frame = scene_in.shown_frame(context)
        context.scene.mimetic.head.rest_frame = frame
        self.report({"INFO"}, f"Footage frame {frame} is the character's pose at rest")
        return {"FINISHED"}


class MIMETIC_OT_bake_head(Job, Operator):
    """Key the head's motion on the chosen object, empty or bone; its other curves stay"""

    bl_idname = "mimetic.bake_head"
    bl_label = "Bake Head"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        if reason := targets.no_head_target(context):
            cls.poll_message_set(reason)
        return not reason

    def read(self, context):
        settings = context.scene.mimetic.head
        return scene_in.take(context), settings.smoothing, _target(settings)

    def work(self, inputs, progress):
        take, smoothing, target = inputs
        performance = takes.load(take)
        if not progress(0.2, "smoothing"):
            return None
        performance = native.head_smoothing().smoothed(performance, smoothing)
        return performance, target, takes.action_name(take, performance), take.clip_name

    def write(self, context, result):
        performance, target, name, clip_name = result
        clip = bpy.data.movieclips.get(clip_name)
        summary = scene_out.head.bake(context.scene, performance, name, target, clip)
        return (
            f"{summary.num_curves} curves from frame {summary.first:.6g} to {summary.last:.6g} "
            f"on {summary.where}"
        )


def _target(settings) -> scene_out.head.Target:
    is_armature = settings.target.type == "ARMATURE"
    return scene_out.head.Target(
        name=settings.target.name,
        bone=settings.bone if is_armature else "",
        neck=settings.neck if is_armature else "",
        neck_share=settings.neck_share,
        is_absolute=settings.mode == "ABSOLUTE",
        rest_frame=settings.rest_frame,
        facing=settings.facing,
        translation_scale=settings.translation_scale if settings.use_translation else 0.0,
        pivot=tuple(settings.pivot),
    )


CLASSES = (
    MIMETIC_OT_track_head,
    MIMETIC_OT_find_head_bones,
    MIMETIC_OT_set_rest_frame,
    MIMETIC_OT_bake_head,
)
