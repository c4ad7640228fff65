# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks that are taught: the list, what each drives, what the set is worth."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel, UIList

from .. import live, live_looks
from .muscles import Muscles
from .paragraph import paragraph

STATE_ICONS = {"LIVE": "CAMERA_DATA", "SLIDERS": "OPTIONS", "EXPRESSION": "ACTION"}


class MIMETIC_UL_looks(UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0):
        row = layout.row(align=True)
        is_kept = item.name in live_looks.kept()
        row.label(text="", icon="CHECKMARK" if is_kept else "DOT")
        row.prop(item, "name", text="", emboss=False)
        if item.frame:
            row.label(text=iface_("frame {frame}").format(frame=item.frame))
        row.label(text="", icon=STATE_ICONS[item.state])


class MIMETIC_PT_live_looks(Muscles, Panel):
    bl_idname = "MIMETIC_PT_live_looks"
    bl_label = "Teach"
    bl_parent_id = "MIMETIC_PT_live"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        row = self.layout.row()
        row.enabled = live.active is None
        row.prop(context.scene.mimetic.live, "use_teaching", text="")

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic.live
        row = layout.row()
        row.template_list(
            "MIMETIC_UL_looks", "", settings, "looks", settings, "active_look", rows=4
        )
        column = row.column(align=True)
        column.operator_menu_enum("mimetic.add_look", "look", text="", icon="ADD")
        column.operator("mimetic.remove_look", text="", icon="REMOVE")
        column.operator("mimetic.add_usual_looks", text="", icon="PRESET")
        look = live_looks.chosen(settings)
        if look is not None:
            self.draw_look(layout, context, look)
        row = layout.row(align=True)
        row.operator("mimetic.keep_look", icon="REC")
        row.operator("mimetic.save_set", icon="FILE_TICK")
        if live.active and live.active.thread.keeper and live.active.thread.keeper.keeping:
            name = live.active.thread.keeper.keeping
            layout.label(text=iface_("Hold it: {name}").format(name=name), icon="TIME")
        for line in filter(None, settings.advice.split("\n")):
            paragraph(layout, line)

    def draw_look(self, layout, context, look):
        column = layout.column(align=True)
        column.row(align=True).prop(look, "parts")
        column.row(align=True).prop(look, "state", expand=True)
        if look.state == "SLIDERS":
            column.operator("mimetic.take_sliders")
        elif look.state == "EXPRESSION":
            column.prop(look, "expression", text="")
        if context.scene.mimetic.live.source == "CLIP":
            column.prop(look, "frame")


CLASSES = (MIMETIC_UL_looks, MIMETIC_PT_live_looks)
