# SPDX-License-Identifier: GPL-3.0-or-later
"""The face's curves: how many keys they have, and edits of many at once."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel

from .. import native, scene_in, scene_out
from .muscles import Muscles


class MIMETIC_PT_curves(Muscles, Panel):
    bl_idname = "MIMETIC_PT_curves"
    bl_label = "Curves"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return not native.problem() and scene_in.shown_face(context) is not None

    def draw(self, context):
        layout = self.layout
        face, parts = scene_in.shown_face(context), scene_out.face_curves
        curves = [row.curve for row in parts.of(face)]
        count = sum(len(curve.keyframe_points) for curve in curves)
        none = "Curves lie in NLA strips" if parts.are_in_strips(face) else "No curves yet"
        layout.label(
            text=iface_("{curves} curves, {keys} keys").format(curves=len(curves), keys=count)
            if curves
            else none
        )
        column = layout.column(align=True)
        row = column.row(align=True)
        row.operator("mimetic.smooth_curves", icon="MOD_SMOOTH")
        row.operator("mimetic.reduce_keys", icon="HANDLE_ALIGNED")
        row = column.row(align=True)
        row.operator("mimetic.exaggerate_curves", icon="FULLSCREEN_ENTER")
        row.operator("mimetic.offset_curves", icon="EMPTY_SINGLE_ARROW")
        row = column.row(align=True)
        row.operator("mimetic.mirror_curves", icon="MOD_MIRROR")
        row.operator("mimetic.retime_curves", icon="TIME")


CLASSES = (MIMETIC_PT_curves,)
