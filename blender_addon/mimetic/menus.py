# SPDX-License-Identifier: GPL-3.0-or-later
"""Every button in a menu too, so that F3 finds it: Object > Mimetic and Clip > Mimetic."""

import bpy
from bpy.types import Menu

from . import native, operators

# None draws a line. In the order of the work, from footage to file, as in the panel
CURVES = (
    *("smooth_curves", "reduce_keys", "exaggerate_curves", "offset_curves", "mirror_curves"),
    "retime_curves",
)
CAPTURED = ("load_performance", "use_captured_take", "remove_captured_take", "find_missing")
TAKES = ("play_take", "compare_take", "blend_takes", "remove_take", "mark_lost", "unmark_lost")
CLIP = (
    *("open_workspace", "load_clip", "scene_as_clip", None),
    *("find_face", "pick_face", "show_landmarks", "pin", "unpin", "follow_pins", None),
    *("calibrate", "capture", "track_head", *CAPTURED, None),
    *("hold_head_still", "release_head", "set_rest_frame", None),
    *("bake", "bake_head", "export_gltf", "export_character", None),
    *(*TAKES, None),
    *CURVES,
)
OBJECT = (
    *("open_workspace", "load_clip", "scene_as_clip", "find_face", "calibrate", None),
    *("capture", "track_head", *CAPTURED, None),
    *("bake", "export_gltf", "export_character", None),
    *(*TAKES, None),
    *(*CURVES, None),
    *("find_head_bones", "bake_head", None),
    *("live", "add_look", "add_usual_looks", "take_sliders", "remove_look", "keep_look", None),
    *("save_set", None),
    *("face_as_lines", None),
    *("add_face", "rest_face", "add_landmarks", "attach_muscles", "add_arkit_shapes", None),
    *("add_control_object", "remove_control_object", None),
    *("fit_controls", "preview_controls", "bake_controls", "mirror_controls"),
    *("save_controls", "load_controls", None),
    *("keep_expression", "apply_expression", "mirror_expression", "sequence_expression"),
    *("compose_expressions", "load_expressions", "save_expression"),
)


def _draw(layout, names) -> None:
    if native.problem():
        layout.label(text=native.problem())
        return
    layout.operator_context = "INVOKE_DEFAULT"
    for name in names:
        if name is None:
            layout.separator()
        else:
            layout.operator(f"mimetic.{name}")


class MIMETIC_MT_clip(Menu):
    bl_idname = "MIMETIC_MT_clip"
    bl_label = "Mimetic"

    def draw(self, context):
        _draw(self.layout, (*CLIP, *_others()))


class MIMETIC_MT_object(Menu):
    bl_idname = "MIMETIC_MT_object"
    bl_label = "Mimetic"

    def draw(self, context):
        _draw(self.layout, OBJECT)


def _others() -> list[str]:
    """Operators that no list names: none is ever out of reach."""
    shown = [one for one in operators.CLASSES if "INTERNAL" not in getattr(one, "bl_options", ())]
    names = [operator.bl_idname.partition(".")[2] for operator in shown]
    return [name for name in names if name not in CLIP and name not in OBJECT]


def _in_clip(menu, context) -> None:
    menu.layout.separator()
    menu.layout.menu(MIMETIC_MT_clip.bl_idname)


def _in_object(menu, context) -> None:
    menu.layout.separator()
    menu.layout.menu(MIMETIC_MT_object.bl_idname)


CLASSES = (MIMETIC_MT_clip, MIMETIC_MT_object)
PLACES = (
    ("CLIP_MT_clip", _in_clip),
    ("VIEW3D_MT_object", _in_object),
    ("VIEW3D_MT_pose", _in_object),
)


def register() -> None:
    for menu in CLASSES:
        bpy.utils.register_class(menu)
    for name, draw in PLACES:
        getattr(bpy.types, name).append(draw)


def unregister() -> None:
    for name, draw in PLACES:
        getattr(bpy.types, name).remove(draw)
    for menu in reversed(CLASSES):
        bpy.utils.unregister_class(menu)
