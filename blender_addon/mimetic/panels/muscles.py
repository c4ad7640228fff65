# SPDX-License-Identifier: GPL-3.0-or-later
"""The face's sliders in the groups that its curves are listed under, and its overlays."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.types import Panel

from .. import contact, native, next_step, scene_in, writable
from ..overlay import live
from ..scene_out import gaze
from .paragraph import one_line, paragraph

GAZE_SLIDERS = ("gaze_yaw_left", "gaze_pitch_left", "gaze_yaw_right", "gaze_pitch_right")


class Muscles:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Mimetic"

    @classmethod
    def poll(cls, context):
        return not native.problem()


class MIMETIC_PT_muscles(Muscles, Panel):
    bl_idname = "MIMETIC_PT_muscles"
    bl_label = "Muscles"

    def draw(self, context):
        layout = self.layout
        face = scene_in.shown_face(context)
        if face is None:
            layout.operator("mimetic.add_face", icon="USER")
            self.draw_attaching(layout, context)
            return
        row = layout.row(align=True)
        has_landmarks = len(face.mimetic.landmarks) > 0
        row.label(text=one_line(face.name, 5 + has_landmarks), icon="USER")
        row.operator("mimetic.rest_face", icon="LOOP_BACK", text="")
        row.operator("mimetic.add_face", icon="ADD", text="")
        row.operator("mimetic.add_arkit_shapes", icon="OUTLINER_OB_FORCE_FIELD", text="")
        if face.mimetic.has_controls:
            row.operator("mimetic.remove_control_object", icon="ARMATURE_DATA", text="")
        else:
            row.operator("mimetic.add_control_object", icon="ARMATURE_DATA", text="")
        moved = next_step.landmarks_moved(context)
        if has_landmarks and not moved:
            row.operator("mimetic.attach_muscles", icon="SHAPEKEY_DATA", text="")
        if moved:
            layout.operator(next_step.ATTACH, icon="SHAPEKEY_DATA", depress=True)
            paragraph(layout, moved)
        if has_landmarks:
            layout.prop(face.mimetic, "use_live_landmarks")
        row = layout.row()
        reason = writable.no_shapes(face) or scene_in.no_edit_mode(face)
        row.enabled = not reason
        row.prop(face.mimetic, "use_contact")
        paragraph(layout, reason or contact.problem_of(face))
        keys = face.data.shape_keys.key_blocks
        groups = {}
        for shape in face.mimetic.shapes:
            if shape.name in keys:
                groups.setdefault(shape.group, []).append(keys[shape.name])
        sliders = {}
        for shape in face.mimetic.groups:
            if shape.name in keys:
                sliders.setdefault(shape.group, []).append(keys[shape.name])
        for group, blocks in groups.items():
            self.draw_group(layout, face, group, sliders.get(group, []), blocks)

    def draw_attaching(self, layout, context):
        active = scene_in.active(context)
        name = active.name if active and active.type == "MESH" else iface_("a head of your own")
        column = layout.column(align=True)
        paragraph(column, iface_("Muscles on {name}:").format(name=name))
        column.operator("mimetic.add_landmarks", icon="EMPTY_DATA")
        column.operator("mimetic.attach_muscles", icon="SHAPEKEY_DATA")
        column.operator("mimetic.add_arkit_shapes", icon="SHAPEKEY_DATA")

    def draw_group(self, layout, face, group, sliders, blocks):
        """A group's own slider in the header, and how far its strongest muscle is; its sides and
        its muscles below."""
        header, body = layout.panel(f"mimetic_{group}", default_closed=True)
        both = next((block for block in sliders if block.name == group), None)
        if both:
            header.prop(both, "value", text=group, slider=True)
        else:
            header.label(text=group)
        if both and blocks:
            strongest = max(abs(block.value) for block in blocks)
            bar = header.row()
            bar.ui_units_x = 1.6  # the longest name of a group fits beside it in 300 pixels
            bar.progress(factor=min(strongest, 1.0), text=f"{strongest:.2f}")
        if not body:
            return
        if sides := [block for block in sliders if block != both]:
            row = body.row(align=True)
            for block in sides:
                row.prop(block, "value", text=block.name.rpartition(".")[2], slider=True)
        column = body.column(align=True)
        if group == "Gaze" and gaze.turns(face):
            for name in GAZE_SLIDERS:
                column.prop(face.mimetic, name, slider=True)
            return
        for block in blocks:
            # As anatomy shortens it: the longest name fits beside its value in 300 pixels
            name = block.name.replace("_superioris_", "_sup_")
            column.prop(block, "value", text=name, slider=True)


class MIMETIC_PT_overlays(Muscles, Panel):
    bl_idname = "MIMETIC_PT_overlays"
    bl_parent_id = "MIMETIC_PT_muscles"
    bl_label = "Overlays"

    @classmethod
    def poll(cls, context):
        face = scene_in.face_of(context)
        return face is not None and scene_in.is_face(face)

    def draw(self, context):
        layout = self.layout
        settings = context.scene.mimetic
        face = scene_in.face_of(context)
        if settings.camera and settings.camera.data.background_images:
            layout.prop(settings, "face_cover", slider=True)
        icon = "CHECKBOX_HLT" if face.display_type == "WIRE" else "CHECKBOX_DEHLT"
        layout.operator("mimetic.face_as_lines", icon=icon)
        paragraph(layout, live.problem_of(face))
        layout.prop(settings, "show_muscles")
        layout.prop(settings, "show_strain")
        column = layout.column(align=True)
        column.active = settings.show_strain
        column.prop(settings, "strain_measure", text="")
        column.prop(settings, "strain_limit")


CLASSES = (MIMETIC_PT_muscles, MIMETIC_PT_overlays)
