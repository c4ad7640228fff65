# SPDX-License-Identifier: GPL-3.0-or-later
"""What is drawn over the footage in the clip editor."""

from bpy.types import Panel

from .. import jobs, native, scene_in, takes
from .paragraph import paragraph


class OfClip:
    """Mixin of panels under the steps in the clip editor's sidebar."""

    bl_parent_id = "MIMETIC_PT_capture_clip"
    bl_space_type = "CLIP_EDITOR"
    bl_region_type = "UI"
    bl_category = "Mimetic"

    @classmethod
    def poll(cls, context):
        return not native.problem() and scene_in.clip_of(context) is not None


class MIMETIC_PT_clip_overlays(OfClip, Panel):
    bl_idname = "MIMETIC_PT_clip_overlays"
    bl_label = "Over the Footage"

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic
        if scene_in.is_undistorted(context.space_data):
            paragraph(layout, scene_in.UNDISTORTED, "ERROR")
        layout.prop(settings, "show_fit")
        if takes.of_clip(context.scene, scene_in.clip_of(context)) is None:
            if jobs.running is None:
                layout.label(text="Capture to see the face in every frame")
            return
        layout.prop(settings, "show_capture")
        column = layout.column(align=True)
        column.active = settings.show_capture
        for name in ("mesh", "features", "landmarks"):
            column.prop(settings, f"show_capture_{name}")
        layout.prop(settings, "show_quality")


CLASSES = (MIMETIC_PT_clip_overlays,)
