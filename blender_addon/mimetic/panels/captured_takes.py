# SPDX-License-Identifier: GPL-3.0-or-later
"""The captured takes of the clip on show: which is used, how well each was captured."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel, UIList

from .. import captured_takes, clips, plural, scene_in, takes
from . import list_rows
from .clip_overlays import OfClip
from .paragraph import paragraph


class MIMETIC_UL_captured_takes(UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0):
        row = layout.row(align=True)
        of_all = [list_rows.range_and_lost(take) for take in data.captured]
        used = "CHECKMARK" if captured_takes.is_used(data, item) else "BLANK1"
        row.label(text="", icon=used if takes.find(item) else "ERROR")
        name = list_rows.row_name(item.name, 1.3 + sum(list_rows.widths(of_all)))
        row.label(text=name)
        list_rows.figures(row, list_rows.range_and_lost(item), of_all)


class MIMETIC_PT_captured_takes(OfClip, Panel):
    bl_idname = "MIMETIC_PT_captured_takes"
    bl_label = "Captured Takes"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return super().poll(context) and len(captured_takes.of_clip(scene_in.clip_of(context))) > 0

    def draw(self, context):
        layout = self.layout
        record = clips.find(scene_in.clip_of(context))
        row = layout.row()
        row.template_list(
            "MIMETIC_UL_captured_takes", "", record, "captured", record, "active_captured", rows=3
        )
        column = row.column(align=True)
        column.operator("mimetic.use_captured_take", text="", icon="CHECKMARK")
        column.operator("mimetic.remove_captured_take", text="", icon="X")
        if 0 <= record.active_captured < len(record.captured):
            self.draw_take(layout.column(align=True), record.captured[record.active_captured])

    def draw_take(self, column, take):
        paragraph(column, takes.name_of(take))
        if not takes.find(take):
            paragraph(column, iface_("{name} is missing").format(name=takes.name_of(take)), "ERROR")
            column.operator("mimetic.find_missing")
        paragraph(
            column,
            plural.one_or_many(
                take.num_lost,
                iface_("quality {quality:.2f}, 1 frame lost"),
                iface_("quality {quality:.2f}, {count} frames lost"),
            ).format(quality=take.quality, count=take.num_lost),
        )
        settings = captured_takes.settings_of(take)
        text = iface_("captured {date}; {settings}").format(date=take.date, settings=settings)
        paragraph(column, text)


CLASSES = (MIMETIC_UL_captured_takes, MIMETIC_PT_captured_takes)
