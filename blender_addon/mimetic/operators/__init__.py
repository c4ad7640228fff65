# SPDX-License-Identifier: GPL-3.0-or-later
"""The buttons: each reads the scene, calls a function that also runs without it, and writes."""

import bpy

from . import (
    bake,
    calibrate,
    capture,
    captured_takes,
    clip,
    control_object,
    corrections,
    curves,
    export,
    expression_strips,
    expressions,
    face,
    face_view,
    foreign,
    gltf,
    head,
    live,
    live_looks,
    missing,
    open_workspace,
    own_controls,
    performance,
    pins,
    scene_time,
    sliders,
    stabilise,
    stop,
    take_list,
)

CLASSES = (
    clip.MIMETIC_OT_load_clip,
    scene_time.MIMETIC_OT_scene_as_clip,
    *face.CLASSES,
    calibrate.MIMETIC_OT_calibrate,
    capture.MIMETIC_OT_capture,
    performance.MIMETIC_OT_load_performance,
    *captured_takes.CLASSES,
    missing.MIMETIC_OT_find_missing,
    bake.MIMETIC_OT_bake,
    *curves.CLASSES,
    *take_list.CLASSES,
    *expressions.CLASSES,
    *expression_strips.CLASSES,
    gltf.MIMETIC_OT_export_gltf,
    export.MIMETIC_OT_export_character,
    *head.CLASSES,
    *stabilise.CLASSES,
    *pins.CLASSES,
    *corrections.CLASSES,
    *foreign.CLASSES,
    *own_controls.CLASSES,
    *control_object.CLASSES,
    *live.CLASSES,
    *live_looks.CLASSES,
    stop.MIMETIC_OT_stop,
    *face_view.CLASSES,
    *open_workspace.CLASSES,
    sliders.MIMETIC_OT_add_face,
    sliders.MIMETIC_OT_rest_face,
)


def register() -> None:
    for operator in CLASSES:
        bpy.utils.register_class(operator)
    sliders.register_menu()
    bpy.types.ASSETBROWSER_MT_context_menu.append(expressions.draw_in_asset_menu)


def unregister() -> None:
    bpy.types.ASSETBROWSER_MT_context_menu.remove(expressions.draw_in_asset_menu)
    sliders.unregister_menu()
    for operator in reversed(CLASSES):
        bpy.utils.unregister_class(operator)
