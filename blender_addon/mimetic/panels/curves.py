# SPDX-License-Identifier: GPL-3.0-or-later
"""The face's curves: how many keys they have, and few of them to drag."""

from bpy.types import Panel

from .. import native, scene_in, scene_out
from .muscles import Muscles


class MIMETIC_PT_curves(Muscles, Panel):
    bl_idname = "MIMETIC_PT_curves"
    bl_label = "Curves"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context):
        return not native.problem() and scene_in.shown_face(context) is not None

    def draw(self, context):
        layout = self.layout
        curves = scene_out.few_keys.curves_of(scene_in.shown_face(context))
        count = sum(len(curve.keyframe_points) for curve in curves)
        layout.label(text=f"{len(curves)} curves, {count} keys" if curves else "No curves yet")
        layout.operator("mimetic.reduce_keys", icon="HANDLE_ALIGNED")


CLASSES = (MIMETIC_PT_curves,)
