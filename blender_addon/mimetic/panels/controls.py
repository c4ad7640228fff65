# SPDX-License-Identifier: GPL-3.0-or-later
"""A character's own controls: how performances drive each of its shape keys."""

from bpy.types import Panel, UIList

from .. import control_preview, native, scene_in, targets
from . import list_rows
from .muscles import Muscles
from .paragraph import paragraph

TYPES = ("MESH", "ARMATURE")
GAIN_UNITS = 2.2  # the names are long; the offset is below the list


class MIMETIC_UL_controls(UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0):
        row = layout.row(align=True)
        row.prop(item, "is_on", text="")
        name = row.row()
        name.active = item.is_on
        shown = list_rows.row_name(item.name, 1.5 + GAIN_UNITS + item.is_edited)
        name.label(text=shown, icon="GREASEPENCIL" if item.is_edited else "NONE")
        gain = row.row()
        gain.active = item.is_on
        gain.ui_units_x = GAIN_UNITS
        gain.prop(item, "gain", text="", emboss=False)


class MIMETIC_PT_controls(Muscles, Panel):
    bl_idname = "MIMETIC_PT_controls"
    bl_label = "Own Controls"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        active = scene_in.active(context)
        return not native.problem() and active is not None and active.type in TYPES

    def draw(self, context):
        layout = self.layout
        face = scene_in.active(context).mimetic
        row = layout.row(align=True)
        row.operator("mimetic.fit_controls", icon="MOD_MESHDEFORM")
        row.operator("mimetic.load_controls", text="", icon="FILE_FOLDER")
        if reason := targets.no_controls(context):
            paragraph(layout, reason)
        if len(face.controls):
            self.draw_table(layout, face)
        row = layout.row(align=True)
        row.operator("mimetic.bake_controls", icon="ACTION")
        is_shown = control_preview.is_of(scene_in.active(context))
        row.operator("mimetic.preview_controls", icon="HIDE_OFF" if is_shown else "HIDE_ON")

    def draw_table(self, layout, face):
        row = layout.row()
        row.template_list(
            "MIMETIC_UL_controls", "", face, "controls", face, "active_control", rows=6
        )
        column = row.column(align=True)
        column.operator("mimetic.mirror_controls", text="", icon="MOD_MIRROR")
        column.operator("mimetic.save_controls", text="", icon="FILE_TICK")
        if not 0 <= face.active_control < len(face.controls):
            return
        control = face.controls[face.active_control]
        box = layout.column(align=True)
        paragraph(box, control.name)
        box.prop(control, "gain")
        box.prop(control, "offset")
        limits = box.row(align=True)
        limits.prop(control, "lowest")
        limits.prop(control, "highest")
        layout.prop(control, "curve")
        paragraph(layout, control.remark)


CLASSES = (MIMETIC_UL_controls, MIMETIC_PT_controls)
