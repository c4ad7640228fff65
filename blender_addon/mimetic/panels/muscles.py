# SPDX-License-Identifier: GPL-3.0-or-later
"""The face's shapes in the 3D view, in the groups that its curves are listed under."""

from bpy.types import Panel

from .. import compat


class MIMETIC_PT_muscles(Panel):
    bl_idname = "MIMETIC_PT_muscles"
    bl_label = "Muscles"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Mimetic"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        face = context.scene.mimetic.face
        return face is not None and face.data.shape_keys is not None

    def draw(self, context):
        keys = context.scene.mimetic.face.data.shape_keys
        groups = {}
        for curve in getattr(compat.curves(keys), "fcurves", ()):
            name = curve.data_path.partition('"')[2].rpartition('"')[0]
            if name in keys.key_blocks and curve.group:
                groups.setdefault(curve.group.name, []).append(keys.key_blocks[name])
        for group, blocks in groups.items():
            header, body = self.layout.panel(f"mimetic_{group}", default_closed=True)
            header.label(text=group)
            if body:
                for block in blocks:
                    body.prop(block, "value", text=block.name, slider=True)


CLASSES = (MIMETIC_PT_muscles,)
