# SPDX-License-Identifier: GPL-3.0-or-later
"""What the selected curves may be off by, in the Graph Editor's sidebar."""

from bpy.types import Panel

from .. import baked_errors, native
from ..overlay import error_bars
from .paragraph import paragraph


class MIMETIC_PT_error_bars(Panel):
    bl_idname = "MIMETIC_PT_error_bars"
    bl_label = "Error Bars"
    bl_space_type = "GRAPH_EDITOR"
    bl_region_type = "UI"
    bl_category = "Mimetic"

    @classmethod
    def poll(cls, context):
        return not native.problem()

    def draw_header(self, context):
        self.layout.prop(context.scene.mimetic, "show_error_bars", text="")

    def draw(self, context):
        layout = self.layout
        layout.active = context.scene.mimetic.show_error_bars
        if reason := error_bars.no_values(context):
            paragraph(layout, reason, "INFO")
        found = baked_errors.of_selected(context)
        if isinstance(found, str):
            paragraph(layout, found)
            return
        for curve in found.curves:
            line = baked_errors.line_of(found, curve, context.scene.frame_current_final)
            paragraph(layout, line)


CLASSES = (MIMETIC_PT_error_bars,)
