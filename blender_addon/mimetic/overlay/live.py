# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces as the overlays see them: read from Blender, and again only when something has changed."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import native, scene_in
from ..scene_out import contact, sliders


@dataclass
class Seen:
    """One face; `problem` says why its muscles are not known."""

    rest: np.ndarray  # V x 3 float32, object frame
    face: object = None  # mimetic.live_face.LiveFace
    problem: str = ""
    values: dict[str, float] = field(default_factory=dict)
    pose: object = None  # mimetic.live_face.Pose; None: to be found again
    made: dict = field(default_factory=dict)  # what was drawn of this pose


_seen: dict[str, Seen] = {}


def forget() -> None:
    _seen.clear()


def mark_changed(name: str) -> None:
    if name in _seen:
        _seen[name].pose = None


def problem_of(face: bpy.types.Object) -> str:
    """Why nothing is drawn over a face that was looked at, or the empty string."""
    return _seen[face.name].problem if face.name in _seen else ""


def faces(context) -> list[bpy.types.Object]:
    """Faces that the 3D view shows and that are not being edited."""
    return [
        shown
        for shown in context.view_layer.objects
        if scene_in.is_face(shown)
        and shown.mode != "EDIT"
        and shown.visible_in_viewport_get(context.space_data)
    ]


def look(face: bpy.types.Object) -> Seen:
    """What is known of a face now: its rest, its sliders, the pose they give."""
    keys = face.data.shape_keys
    rest = contact.points_of(keys.reference_key)
    seen = _seen.get(face.name)
    if seen is None or not np.array_equal(seen.rest, rest):
        seen = _seen[face.name] = _new(rest)
    if seen.face is None:
        return seen
    values = _values(face)
    if seen.pose is None or values != seen.values:
        seen.values = values
        seen.pose = seen.face.pose(sliders.moves(keys, values, rest), values)
        seen.made.clear()
    return seen


def _new(rest: np.ndarray) -> Seen:
    if reason := native.problem():
        return Seen(rest, problem=reason)
    try:
        return Seen(rest, native.live_face().LiveFace(rest))
    except native.known_errors() as error:
        return Seen(rest, problem=str(error))


def _values(face: bpy.types.Object) -> dict[str, float]:
    if face.show_only_shape_key:  # the pin in the list of shape keys
        return {face.active_shape_key.name: 1.0}
    return sliders.values_of(face)
