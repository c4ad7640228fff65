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
    drawings: dict = field(default_factory=dict)  # what was drawn of this pose


_views: dict[str, Seen] = {}


def forget() -> None:
    _views.clear()


def mark_changed(name: str) -> None:
    if name in _views:
        _views[name].pose = None


def problem_of(face: bpy.types.Object) -> str:
    """Why nothing is drawn over a face, or the empty string."""
    return _views[face.name].problem if face.name in _views else ""


def faces(context) -> list[bpy.types.Object]:
    """Faces that the 3D view shows and that are not being edited."""
    return [
        obj
        for obj in context.view_layer.objects
        if scene_in.is_face(obj)
        and obj.mode != "EDIT"
        and obj.visible_in_viewport_get(context.space_data)
    ]


def look(face: bpy.types.Object) -> Seen:
    """What is known of a face now: its rest, its sliders, the pose they give."""
    keys = face.data.shape_keys
    rest = contact.points_of(keys.reference_key)
    view = _views.get(face.name)
    if view is None or not np.array_equal(view.rest, rest):
        view = _views[face.name] = _new(rest)
    if view.face is None:
        return view
    values = _values(face)
    if view.pose is None or values != view.values:
        view.values = values
        view.pose = view.face.pose(sliders.moves(face, values, rest), values)
        view.drawings.clear()
    return view


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
