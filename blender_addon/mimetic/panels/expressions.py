# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions that were kept: chosen by their pictures, blended on the face, put in sequence."""

from bpy.types import Panel

from .muscles import Muscles


class MIMETIC_PT_expressions(Muscles, Panel):
    bl_idname = "MIMETIC_PT_expressions"
    bl_label = "Expressions"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic
        layout.prop(settings, "expression", text="")
        if settings.expression is not None:
            # Blender's template for data with previews shows none of an action's
            layout.template_icon(settings.expression.preview_ensure().icon_id, scale=6)
        row = layout.row(align=True)
        row.operator("mimetic.apply_expression", text="Blend", icon="MOUSE_MOVE")
        row.operator_context = "EXEC_DEFAULT"
        row.operator("mimetic.apply_expression", text="Apply", icon="CHECKMARK").share = 1.0
        row.operator("mimetic.mirror_expression", text="", icon="MOD_MIRROR")
        column = layout.column(align=True)
        column.operator("mimetic.sequence_expression", icon="NLA")
        column.operator("mimetic.compose_expressions", icon="NODE_COMPOSITING")
        column = layout.column(align=True)
        column.operator("mimetic.keep_expression", icon="ADD")
        column.operator("mimetic.load_expressions", icon="IMPORT")
        column.operator("mimetic.save_expression", icon="EXPORT")


CLASSES = (MIMETIC_PT_expressions,)
