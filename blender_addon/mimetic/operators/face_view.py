# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.types import Operator

from .. import outcome, scene_in
from ..greyed import Greyed
from ..scene_out import cover


class MIMETIC_OT_face_as_lines(Greyed, Operator):
    """Show the face as lines through which the footage is seen, or as it was before"""

    bl_idname = "mimetic.face_as_lines"
    bl_label = "Face as Lines"
    bl_options = {"UNDO"}

    @classmethod
    def obstacle(cls, context):
        if scene_in.face_of(context) is None:
            return "Press Bake or Add Face first: the scene has no face"
        return ""

    def execute(self, context):
        face = scene_in.face_of(context)
        is_wire = not cover.is_wire(face)
        cover.show_wire(face, is_wire)
        return outcome.finished(self, context, "", object=face.name, is_wire=is_wire)


CLASSES = (MIMETIC_OT_face_as_lines,)
