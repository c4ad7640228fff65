# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections of single frames of the captured face, in the clip editor."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel

from .. import corrections, scene_in
from ..stated_parts import stated_parts
from .clip_overlays import OfClip

DRAGS = (("MOVE", "VIEW_PAN"), ("TURN", "FILE_REFRESH"))
REFINEMENTS = (("BACKWARD", "BACK"), ("BOTH", "ARROW_LEFTRIGHT"), ("FORWARD", "FORWARD"))


class MIMETIC_PT_corrections(OfClip, Panel):
    bl_idname = "MIMETIC_PT_corrections"
    bl_label = "Corrections"

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic
        pin = layout.operator("mimetic.pin_skin", icon="PINNED")
        pin.reach = settings.correction_reach
        row = layout.row(align=True)
        row.prop(settings, "correction_name", text="")
        value = row.operator("mimetic.correct_value", text="Correct")
        value.value_name, value.reach = settings.correction_name, settings.correction_reach
        row = layout.row(align=True)
        pose = row.operator("mimetic.correct_pose", icon="ORIENTATION_GIMBAL")
        pose.reach = settings.correction_reach
        for mode, icon in DRAGS:
            drag = row.operator("mimetic.drag_pose", text="", icon=icon)
            drag.mode, drag.reach = mode, settings.correction_reach
        layout.prop(settings, "correction_reach")
        shown = scene_in.shown_frame(context)
        for entry in corrections.readable(scene_in.clip_of(context)):
            self.draw_frame(layout, entry, entry.frame == shown)
        row = layout.row(align=True)
        for direction, icon in REFINEMENTS:
            text = "Refine" if direction == "BOTH" else ""
            row.operator("mimetic.refine", text=text, icon=icon).direction = direction

    def draw_frame(self, layout, entry, is_shown: bool) -> None:
        """A corrected frame; of the one on show all that is stated, each with its cross."""
        column = layout.column(align=True)
        row = column.row(align=True)
        text = iface_("Frame {frame}").format(frame=entry.frame)
        icon = "RADIOBUT_ON" if is_shown else "RADIOBUT_OFF"
        row.operator("mimetic.show_correction", text=text, icon=icon).frame = entry.frame
        row.operator("mimetic.delete_correction", text="", icon="X").frame = entry.frame
        for part in stated_parts(entry) if is_shown else ():
            row = column.row(align=True)
            if part.operator:
                button = row.operator(part.operator, text=part.text, icon=part.icon)
                button.frame, button.reach = entry.frame, entry.reach
                if part.operator == "mimetic.correct_value":
                    button.value_name = part.name
            else:
                row.label(text=part.text, icon=part.icon)
            cross = row.operator("mimetic.delete_correction", text="", icon="X")
            cross.frame, cross.what = entry.frame, part.name


CLASSES = (MIMETIC_PT_corrections,)
