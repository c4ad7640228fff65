# SPDX-License-Identifier: GPL-3.0-or-later
from pathlib import Path

import bpy
from bpy.props import BoolProperty, IntProperty
from bpy.types import Operator

from .. import native, scene_in, scene_out, targets
from ..jobs import Job


class MIMETIC_OT_bake(Job, Operator):
    """Put the performance into the scene: face, muscle curves, head motion, footage and camera"""

    bl_idname = "mimetic.bake"
    bl_label = "Bake"
    bl_options = {"REGISTER", "UNDO"}

    subdivision: IntProperty(
        name="Subdivision", default=1, min=0, max=3, description="Levels in the viewport"
    )
    use_texture: BoolProperty(
        name="Footage as Skin", default=True, description="Project a frame of the clip on the skin"
    )
    use_contact: BoolProperty(
        name="Contact",
        default=True,
        description="Let lips rest on each other and lids on each other, by shapes of their own",
    )
    use_detail: BoolProperty(
        name="Detail",
        default=False,
        description="Shapes of their own for what the muscles leave unexplained: the surface as "
        "closely as it was seen, and some eighty curves that no hand edits",
    )
    use_view: BoolProperty(
        name="Look Through Camera", default=True, description="Turn 3D views to the footage"
    )

    @classmethod
    def poll(cls, context):
        if reason := targets.no_bake(context):
            cls.poll_message_set(reason)
        return not reason

    def read(self, context):
        clip = scene_in.clip_of(context)
        footage = scene_in.footage(context).path if clip and self.use_texture else None
        path = scene_in.performance_path(context.scene)
        return path, footage, clip.name if clip else "", self.use_contact, self.use_detail

    def work(self, inputs, progress):
        path, footage, clip_name, use_contact, use_detail = inputs
        performance = native.part("performance").Performance.load(path)
        if not use_detail:
            performance = performance.without_detail()
        contact = None
        if use_contact:
            contact = native.part("contact_shapes").contact_shapes(performance, progress)
        if not progress(0.9, "projecting the texture" if footage else "painting"):
            return None
        appearance = native.part("appearance").appearance_of(performance, footage)
        take = Path(clip_name or path).name.split(".")[0]
        return performance, appearance, contact, take, clip_name

    def write(self, context, result):
        performance, appearance, contact, take, clip_name = result
        clip = bpy.data.movieclips.get(clip_name)
        baked = scene_out.bake(
            context.scene,
            performance,
            take,
            appearance,
            clip,
            self.subdivision,
            contact_shapes=contact,
        )
        face = context.scene.mimetic.face
        told = (
            f"{baked.num_curves} curves from frame {baked.first:.6g} to {baked.last:.6g} "
            f"on {face.name}"
        )
        if self.use_view and scene_out.camera.look_through(context, face):
            told += "; other objects are out of view, View > Local View shows them again"
        scene_out.canonical.select_only(context.view_layer, face)
        return told
