# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty
from bpy.types import Operator

from .. import native, outcome, scene_in, scene_out, targets
from ..greyed import Greyed


class MIMETIC_OT_add_control_object(Greyed, Operator):
    """Give the face an armature whose bones drive its sliders: for pose libraries, pasting mirrored
    poses and a gaze target. One that was deleted is made again"""

    bl_idname = "mimetic.add_control_object"
    bl_label = "Add Control Object"
    bl_options = {"REGISTER", "UNDO"}

    obstacle = staticmethod(targets.no_added_controls)

    def execute(self, context):
        face = scene_in.face_of(context)
        # Not `obstacle`'s: the redo panel asks that while what it will undo is still there
        if control := scene_out.control_object.of(face):
            return outcome.cancelled(
                self,
                context,
                rpt_("{face} has one already: {control}").format(
                    face=face.name, control=control.name
                ),
            )
        try:
            control = scene_out.control_object.ensure(context.scene, face)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        scene_out.canonical.select_only(context.view_layer, control)
        num_bones = len(control.data.bones)
        message = rpt_(
            "{control} drives {face} by {num_bones} bones: Pose Mode, sidebar, Item"
        ).format(control=control.name, face=face.name, num_bones=num_bones)
        return outcome.finished(
            self, context, message, object=control.name, face=face.name, num_bones=num_bones
        )


class MIMETIC_OT_remove_control_object(Greyed, Operator):
    """Take the face's control object away"""

    bl_idname = "mimetic.remove_control_object"
    bl_label = "Remove Control Object"
    bl_options = {"REGISTER", "UNDO"}

    use_curves: BoolProperty(
        name="Keep Motion",
        default=True,
        description="Key what it does on the shape keys, a key a frame; otherwise the face stays "
        "as it looks now. Its takes stay in the file either way",
    )

    obstacle = staticmethod(scene_in.no_face)

    def execute(self, context):
        face = scene_in.face_of(context)
        if not face.mimetic.has_controls:
            return outcome.cancelled(
                self, context, rpt_("{face} has no control object").format(face=face.name)
            )
        control = scene_out.control_object.of(face)
        other = scene_out.control_object.other_face(face)
        try:
            num_curves = scene_out.control_removal.remove(context.scene, face, self.use_curves)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        scene_out.canonical.select_only(context.view_layer, face)
        message = rpt_("{face} is driven by its shape keys again").format(face=face.name)
        if num_curves:
            message += rpt_(", whose motion is {num_curves} curves of its own now").format(
                num_curves=num_curves
            )
        if other is not None:
            message += rpt_("; {control} stays: it drives {other}").format(
                control=control.name, other=other.name
            )
        return outcome.finished(self, context, message, object=face.name, num_curves=num_curves)


CLASSES = (MIMETIC_OT_add_control_object, MIMETIC_OT_remove_control_object)
