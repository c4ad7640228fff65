# SPDX-License-Identifier: GPL-3.0-or-later
"""The head alone: following it, and putting its motion on characters."""

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, IntProperty, StringProperty
from bpy.types import Operator

from .. import native, outcome, scene_in, scene_out, takes, targets
from ..greyed import Greyed
from ..jobs import Job
from ..properties import MimeticHead
from . import arguments
from .following import Following

MODELS = (
    ("SURFACE", "Surface", "The person's fitted surface: the most accurate"),
    ("ELLIPSOID", "Ellipsoid", "An ellipsoid around the head"),
    ("PLANE", "Plane", "A planar patch on the face; loses heads that turn far"),
)


# Of the panel, which a call may give
HEAD_SETTINGS = (
    *("bone", "neck", "neck_share", "mode", "rest_frame", "facing"),
    *("use_translation", "translation_scale", "pivot", "smoothing"),
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
    def follow(option, footage_path, progress, **what):
        track_head = native.head_tracking().track_head
        return track_head(footage_path, option, progress=progress, **what)


class MIMETIC_OT_find_head_bones(Greyed, Operator):
    """Choose the armature's head and neck by their usual names, as in Rigify's rigs"""

    bl_idname = "mimetic.find_head_bones"
    bl_label = "Find Head Bones"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def obstacle(cls, context):
        target = context.scene.mimetic.head.target
        reason = scene_in.no_start()
        if not reason and (target is None or target.type != "ARMATURE"):
            reason = "Choose an armature as the target first"
        return reason

    def execute(self, context):
        settings = context.scene.mimetic.head
        bones = scene_out.rigs.head_bones(settings.target)
        if not bones.head:
            return outcome.cancelled(self, context, bones.remark)
        settings.bone, settings.neck = bones.head, bones.neck
        message = rpt_("Head {head}, neck {neck}").format(
            head=bones.head, neck=bones.neck or rpt_("none")
        )
        return outcome.finished(self, context, message, bone=bones.head, neck=bones.neck)


class MIMETIC_OT_set_rest_frame(Greyed, Operator):
    """Take the frame on show as the one in which actor and character hold their heads alike"""

    bl_idname = "mimetic.set_rest_frame"
    bl_label = "Rest at Shown Frame"
    bl_options = {"REGISTER", "UNDO"}

    frame: IntProperty(
        name="Frame",
        min=0,
        options=arguments.OF_ONE_CALL,
        description="Footage frame; 0: the one on show",
    )

    obstacle = staticmethod(scene_in.no_clip)

    def execute(self, context):
        frame = self.frame or scene_in.shown_frame(context)
        if reason := scene_in.no_footage_frame(scene_in.clip_of(context), frame):
            return outcome.cancelled(self, context, reason)
        context.scene.mimetic.head.rest_frame = frame
        message = rpt_("Footage frame {frame} is the character's pose at rest").format(frame=frame)
        return outcome.finished(self, context, message, frame=frame)


class MIMETIC_OT_bake_head(Job, Operator):
    """Key the head's motion on the chosen object, empty or bone; its other curves stay"""

    bl_idname = "mimetic.bake_head"
    bl_label = "Bake Head"
    bl_options = {"REGISTER", "UNDO"}

    target: StringProperty(
        name="Target",
        options=arguments.OF_ONE_CALL,
        description="Name of the object, empty or armature that the head's motion goes to",
    )
    bone: arguments.like(MimeticHead, "bone")
    neck: arguments.like(MimeticHead, "neck")
    neck_share: arguments.like(MimeticHead, "neck_share")
    mode: arguments.like(MimeticHead, "mode")
    rest_frame: arguments.like(MimeticHead, "rest_frame")
    facing: arguments.like(MimeticHead, "facing")
    use_translation: arguments.like(MimeticHead, "use_translation")
    translation_scale: arguments.like(MimeticHead, "translation_scale")
    pivot: arguments.like(MimeticHead, "pivot")
    smoothing: arguments.like(MimeticHead, "smoothing")

    @classmethod
    def obstacle(cls, context):
        # A script may name the target in its call, which is not known here
        is_named_later = bpy.app.background and context.scene.mimetic.head.target is None
        check = targets.no_head_take if is_named_later else targets.no_head_target
        reason = check(context)
        return reason

    def read(self, context):
        settings = context.scene.mimetic.head
        if self.target:
            settings.target = _named(context.scene, self.target)
        arguments.set_given(self, HEAD_SETTINGS, settings)
        if reason := targets.no_head_target(context):
            raise native.invalid_input(reason)
        return scene_in.take(context), settings.smoothing, _target(context.scene)

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
        frames = [summary.first, summary.last]
        self.facts = {"num_curves": summary.num_curves, "scene_frames": frames}
        self.facts |= {"object": target.name, "bone": target.bone, "neck": target.neck}
        return rpt_("{num_curves} curves from frame {first:.6g} to {last:.6g} on {name}").format(
            num_curves=summary.num_curves,
            first=summary.first,
            last=summary.last,
            name=summary.where,
        )


def _named(scene: bpy.types.Scene, name: str) -> bpy.types.Object:
    if name not in scene.objects:
        raise native.invalid_input(rpt_("the scene has no object {name}").format(name=name))
    return scene.objects[name]


def _target(scene: bpy.types.Scene) -> scene_out.head.Target:
    settings, metre = scene.mimetic.head, scene.unit_settings.scale_length or 1.0
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
        pivot=tuple(metre * part for part in settings.pivot),
    )


CLASSES = (
    MIMETIC_OT_track_head,
    MIMETIC_OT_find_head_bones,
    MIMETIC_OT_set_rest_frame,
    MIMETIC_OT_bake_head,
)
