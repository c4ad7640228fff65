# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on characters, and the clip with the head held still."""

from bpy.types import Panel

from .. import native, scene_in, targets
from ..scene_out import rigs
from .paragraph import paragraph


class Head:
    bl_label = "Head"
    bl_region_type = "UI"
    bl_category = "Mimetic"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return not native.problem()

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic.head
        clip = scene_in.clip_of(context)
        row = layout.row(align=True)
        row.operator("mimetic.hold_head_still", icon="PINNED")
        if clip and scene_in.is_held(clip):
            row.operator("mimetic.release_head", text="", icon="X")
        layout.prop(settings, "smoothing")
        layout.prop(settings, "target", text="")
        if settings.target is not None:
            self.draw_target(layout, context, settings)
        layout.operator("mimetic.bake_head", icon="ACTION")

    def draw_target(self, layout, context, settings):
        target = settings.target
        reason = targets.no_head_target(context)
        if target.type == "ARMATURE":
            self.draw_bones(layout, settings, reason)
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(settings, "mode")
        row = column.row(align=True)
        row.prop(settings, "rest_frame", text="At Rest in")
        row.operator("mimetic.set_rest_frame", text="", icon="TIME")
        column.prop(settings, "facing")
        column.prop(settings, "use_translation")
        if settings.use_translation:
            column.prop(settings, "translation_scale")
            if settings.mode == "RELATIVE" or settings.bone:
                column.prop(settings, "pivot")
        paragraph(layout, reason)

    def draw_bones(self, layout, settings, reason):
        row = layout.row(align=True)
        row.prop_search(settings, "bone", settings.target.pose, "bones", text="", icon="BONE_DATA")
        row.operator("mimetic.find_head_bones", text="", icon="VIEWZOOM")
        remark = rigs.head_bones(settings.target).remark
        if not settings.bone and remark != reason:
            paragraph(layout, remark)
        layout.prop_search(settings, "neck", settings.target.pose, "bones", text="Neck")
        if settings.neck:
            layout.prop(settings, "neck_share", slider=True)


class MIMETIC_PT_head_clip(Head, Panel):
    bl_idname = "MIMETIC_PT_head_clip"
    bl_space_type = "CLIP_EDITOR"


class MIMETIC_PT_head_view(Head, Panel):
    bl_idname = "MIMETIC_PT_head_view"
    bl_space_type = "VIEW_3D"


CLASSES = (MIMETIC_PT_head_clip, MIMETIC_PT_head_view)
