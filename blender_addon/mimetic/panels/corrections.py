# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections of single frames of the captured face, in the clip editor."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel

from .. import corrections, scene_in
from .clip_overlays import OfClip

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
        pose = layout.operator("mimetic.correct_pose", icon="ORIENTATION_GIMBAL")
        pose.reach = settings.correction_reach
        layout.prop(settings, "correction_reach")
        shown = scene_in.shown_frame(context)
        for frame in corrections.frames_of(scene_in.clip_of(context)):
            row = layout.row(align=True)
            icon = "RADIOBUT_ON" if frame == shown else "RADIOBUT_OFF"
            text = iface_("Frame {frame}").format(frame=frame)
            row.operator("mimetic.show_correction", text=text, icon=icon).frame = frame
            row.operator("mimetic.delete_correction", text="", icon="X").frame = frame
        row = layout.row(align=True)
        for direction, icon in REFINEMENTS:
            text = "Refine" if direction == "BOTH" else ""
            row.operator("mimetic.refine", text=text, icon=icon).direction = direction


CLASSES = (MIMETIC_PT_corrections,)
