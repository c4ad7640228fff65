# SPDX-License-Identifier: GPL-3.0-or-later
"""The buttons: each reads the scene, calls a function that also runs without it, and writes."""

import bpy

from . import bake, capture, clip, face, gltf, performance

CLASSES = (
    clip.MIMETIC_OT_load_clip,
    face.MIMETIC_OT_find_face,
    capture.MIMETIC_OT_capture,
    performance.MIMETIC_OT_load_performance,
    bake.MIMETIC_OT_bake,
    gltf.MIMETIC_OT_export_gltf,
)


def register() -> None:
    for operator in CLASSES:
        bpy.utils.register_class(operator)


def unregister() -> None:
    for operator in reversed(CLASSES):
        bpy.utils.unregister_class(operator)
