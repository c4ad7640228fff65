# SPDX-License-Identifier: GPL-3.0-or-later
"""The baked takes of the active face or character: which plays, how well each was captured."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel, UIList

from .. import native, plural, scene_out, targets
from . import list_rows
from .muscles import Muscles
from .paragraph import paragraph


class MIMETIC_UL_takes(UIList):
    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index=0):
        row = layout.row(align=True)
        playing = scene_out.take_list.playing(item.id_data)
        is_playing = playing is not None and playing.name == item.name
        of_all = [list_rows.range_and_lost(take) for take in data.takes]
        row.label(text="", icon="PLAY" if is_playing else "ACTION")
        beside = 1.3 + item.is_edited + sum(list_rows.widths(of_all))
        name = list_rows.row_name(item.name, beside)
        row.label(text=name, icon="GREASEPENCIL" if item.is_edited else "NONE")
        list_rows.figures(row, list_rows.range_and_lost(item), of_all)


class MIMETIC_PT_takes(Muscles, Panel):
    bl_idname = "MIMETIC_PT_takes"
    bl_label = "Baked Takes"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return not native.problem() and targets.take_owner(context) is not None

    def draw(self, context):
        layout = self.layout
        obj = targets.take_owner(context)
        face = obj.mimetic
        if not len(face.takes):
            paragraph(layout, iface_("{name}: no take yet").format(name=obj.name))
            return
        row = layout.row()
        row.template_list("MIMETIC_UL_takes", "", face, "takes", face, "active_take", rows=3)
        column = row.column(align=True)
        column.operator("mimetic.play_take", text="", icon="PLAY")
        column.operator("mimetic.remove_take", text="", icon="X")
        if 0 <= face.active_take < len(face.takes):
            self.draw_take(layout, face.takes[face.active_take])
        row = layout.row(align=True)
        row.operator("mimetic.compare_take", text="Compare", icon="MOD_ARRAY")
        row.operator("mimetic.blend_takes", icon="NLA")
        row = layout.row(align=True)
        row.operator("mimetic.mark_lost", icon="MARKER_HLT")
        if scene_out.lost_markers.ours(context.scene):
            row.operator("mimetic.unmark_lost", text="", icon="X")

    def draw_take(self, layout, take):
        column = layout.column(align=True)
        lines = [
            take.name,
            iface_("{footage}, frames {first} to {last}").format(
                footage=take.clip or take.performance, first=take.first, last=take.last
            ),
            plural.one_or_many(
                take.num_lost,
                iface_("quality {quality:.2f}, 1 frame lost"),
                iface_("quality {quality:.2f}, {count} frames lost"),
            ).format(quality=take.quality, count=take.num_lost),
            iface_("baked {date}; {settings}").format(date=take.date, settings=take.settings),
        ]
        for line in lines:
            paragraph(column, line)
        if take.is_edited:
            column.label(text="Edited since its bake", icon="GREASEPENCIL")


CLASSES = (MIMETIC_UL_takes, MIMETIC_PT_takes)
