# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on characters, and the clip with the head held still."""

from bpy.types import Panel

from .. import native, scene_in
from ..scene_out import rigs
from .capture import wrapped


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
        if target.type == "ARMATURE":
            self.draw_bones(layout, settings)
        column = layout.column()
        column.use_property_split = True
        column.use_property_decorate = False
        column.prop(settings, "mode")
        row = column.row(align=True)
        row.prop(settings, "calibration_frame", text="Calibrate at")
        row.operator("mimetic.calibrate_head", text="", icon="TIME")
        column.prop(settings, "facing")
        column.prop(settings, "use_translation")
        if settings.use_translation:
            column.prop(settings, "translation_scale")
            if settings.mode == "RELATIVE" or settings.bone:
                column.prop(settings, "pivot")
        if reason := scene_in.no_head_target(context):
            for line in wrapped(reason, 44):
                layout.label(text=line)

    def draw_bones(self, layout, settings):
        row = layout.row(align=True)
        row.prop_search(settings, "bone", settings.target.pose, "bones", text="", icon="BONE_DATA")
        row.operator("mimetic.find_head_bones", text="", icon="VIEWZOOM")
        if not settings.bone:
            for line in wrapped(rigs.head_bones(settings.target).remark, 44):
                layout.label(text=line)
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
