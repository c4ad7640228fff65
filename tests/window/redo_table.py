# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: every operator that has settings to try out in its redo panel, with
the scene that it needs and the setting that is changed there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
import redo_scenes as scenes
from redo_panels import BLENDERS
from undoing import module


@dataclass
class Trial:
    """An operator, and what is changed in its redo panel."""

    name: str
    scene: Callable
    setting: str
    typed: str = ""  # or how often Down is pressed in a list
    options: dict = field(default_factory=dict)  # of the call
    kind: str = "VIEW_3D"  # of editor
    row: int = -1  # of the panel, where the operator draws its own
    is_file: bool = False  # what is typed, beside the walk's own


MOTION = {"kind": "MOTION", "frame_first": 1, "frame_last": 20}
JAW = {"value_name": "jaw_open", "value": 0.4}
PIN = {"grab": (200.0, 160.0), "to": (205.0, 160.0)}
SECOND_FOLDER = ("directory", "second", {"directory": "first"})
SECOND_FILE = ("filepath", "second.json", {"filepath": "first.json"})
IN_CLIP = {"kind": "CLIP_EDITOR"}

TABLE = (
    Trial("bake", scenes.plain, "exaggeration", "1.5", scenes.PLAIN, row=3),
    Trial("add_face", scenes.plain, "subdivision", "2"),
    Trial("add_look", scenes.plain, "look", options={"look": "smile"}),
    Trial("reduce_keys", scenes.face, "tolerance", "0.2"),
    Trial("smooth_curves", scenes.face, "seconds", "0.3"),
    Trial("exaggerate_curves", scenes.face, "factor", "0.5"),
    Trial("offset_curves", scenes.face, "by"),
    Trial("mirror_curves", scenes.face, "how"),
    Trial("retime_curves", scenes.face, "frames_later", "7"),
    Trial("keep_expression", scenes.face, "frame_last", "12", MOTION, row=4),
    Trial("play_take", scenes.three_takes, "take", "again", {"take": "hero"}),
    Trial("remove_take", scenes.three_takes, "take", "again", {"take": "hero"}),
    Trial("compare_take", scenes.three_takes, "take", "again", {"take": "hero"}),
    Trial("blend_takes", scenes.three_takes, "influence", "0.25", {"take": "hero"}),
    Trial("mark_lost", scenes.three_takes, "take", "again", {"take": "hero"}),
    Trial("remove_control_object", scenes.control_object, "use_curves"),
    Trial("apply_expression", scenes.expression, "share", "0.25", {"action": "smile"}),
    Trial("mirror_expression", scenes.expression, "action", "brows", {"action": "smile"}),
    Trial("sequence_expression", scenes.expression, "strength", "0.5", {"action": "smile"}),
    Trial("load_expressions", scenes.plain, *SECOND_FOLDER, is_file=True),
    Trial("attach_muscles", scenes.landmarks, "others", "3"),
    Trial("add_arkit_shapes", scenes.landmarks, "others", "3"),
    Trial("fit_controls", scenes.character, "reset_edits"),
    Trial("bake_controls", scenes.character, "exaggeration", "0.5", row=3),
    Trial("mirror_controls", scenes.character, "from_side"),
    Trial("load_controls", scenes.character, *SECOND_FILE, is_file=True),
    Trial("correct_value", scenes.captured, "value", "0.7", JAW, **IN_CLIP),
    Trial("correct_pose", scenes.captured, "reach", "12", {"turn": (0.0, 5.0, 0.0)}, **IN_CLIP),
    Trial("drag_pose", scenes.captured, "reach", "12", {"shift": (0.01, 0.0, 0.0)}, **IN_CLIP),
    Trial("pin_skin", scenes.captured, "std", "3", PIN, **IN_CLIP),
    Trial("delete_correction", scenes.corrected, "frame", str(scenes.OTHER), **IN_CLIP),
)


def settings_of(name: str) -> list[str]:
    """What an operator's redo panel shows."""
    kind = getattr(bpy.ops.mimetic, name).get_rna_type()
    shown = [prop for prop in kind.properties if not prop.is_hidden]
    return [prop.identifier for prop in shown if prop.identifier not in BLENDERS]


def with_settings() -> set[str]:
    """Of all operators of the extension those whose redo panel has settings."""
    registered = [
        operator.bl_idname.partition(".")[2]
        for operator in module("operators").CLASSES
        if "REGISTER" in getattr(operator, "bl_options", ())
    ]
    return {name for name in registered if settings_of(name)}
