# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, IntProperty
from bpy.types import Operator

from .. import native, outcome, scene_in, scene_out, targets, writable
from ..greyed import Greyed
from ..jobs import Job


class MIMETIC_OT_add_face(Job, Operator):
    """Add a head with sliders for its muscles, jaw and lids, to animate without footage"""

    bl_idname = "mimetic.add_face"
    bl_label = "Add Face"
    bl_options = {"REGISTER", "UNDO"}

    subdivision: IntProperty(
        name="Subdivision", default=1, min=0, max=3, description="Levels in the viewport"
    )
    use_units: BoolProperty(
        name="Action Units",
        description="Sliders of FACS's action units too, left and right, and an asset of each",
    )

    @classmethod
    def obstacle(cls, context):
        reason = scene_in.no_start()
        if not reason and context.mode != "OBJECT":
            reason = "Leave the edit mode first"
        return reason or writable.no_objects(context.scene)

    def read(self, context):
        return self.use_units

    def work(self, inputs, progress):
        head = native.canonical_head().make_head()
        return head, native.shapes().shapes_of_units(head.vertices) if inputs else []

    def write(self, context, result):
        head, units = result
        scene = context.scene
        (collection,) = writable.collections_for(scene, [context.collection])
        face = scene_out.canonical.add(
            collection, head, scene.cursor.location, self.subdivision, units
        )
        if units:
            rate = scene_in.timing(scene, None).scene_rate
            scene_out.expressions.ensure_units(rate)
        scene_out.canonical.select_only(context.view_layer, face)
        num_sliders = len(head.shapes) + len(units) + len(head.groups)
        self.facts = {"object": face.name, "num_sliders": num_sliders}
        return rpt_("{name} has {num_sliders} sliders: sidebar, Mimetic, Muscles").format(
            name=face.name, num_sliders=num_sliders
        )


class MIMETIC_OT_rest_face(Greyed, Operator):
    """Put all sliders of the face to 0; curves stay as they are"""

    bl_idname = "mimetic.rest_face"
    bl_label = "Rest Face"
    bl_options = {"REGISTER", "UNDO"}

    obstacle = staticmethod(targets.no_rest)

    def execute(self, context):
        face = scene_in.face_of(context)
        scene_out.sliders.rest(face)
        return outcome.finished(self, context, "", object=face.name)


def draw_in_menu(menu, context) -> None:
    """The entry in Add > Mesh."""
    menu.layout.operator(MIMETIC_OT_add_face.bl_idname, text="Mimetic Face", icon="USER")


def register_menu() -> None:
    bpy.types.VIEW3D_MT_mesh_add.append(draw_in_menu)


def unregister_menu() -> None:
    bpy.types.VIEW3D_MT_mesh_add.remove(draw_in_menu)
