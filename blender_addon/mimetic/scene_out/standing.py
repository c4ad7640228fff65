# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an object stood before its head's motion was keyed: a second take starts from there too.

The take's action remembers it, so that it is known whether the action is assigned or played by a
strip, and wherever its keys are by now. Where the scene happens to be when a button is pressed must
not count: the head is anywhere then.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace

import bpy

from .. import compat

KEPT = "mimetic_stood"  # of an action: a `Stand` as JSON; "" where it counts how the object stands
ROTATIONS = {"QUATERNION": "rotation_quaternion", "AXIS_ANGLE": "rotation_axis_angle"}  # else Euler


@dataclass(frozen=True)
class Stand:
    """An object's own transform, without its scale."""

    location: tuple[float, ...]
    mode: str  # of the rotation
    rotation: tuple[float, ...]  # as that mode has it

    @property
    def rotation_path(self) -> str:
        return ROTATIONS.get(self.mode, "rotation_euler")


def of(obj: bpy.types.Object) -> Stand:
    """Where an object stood before takes of ours moved it, whether these play as actions or strips;
    what none moves, as it is now."""
    stand = _now(obj)
    action, slot = next(((a, slot) for a, slot in _playing(obj) if KEPT in a), (None, ""))
    if action is None or (stood := _noted(action)) is None:
        return stand
    paths = compat.paths_of(action, slot)
    if "location" in paths:
        stand = replace(stand, location=stood.location)
    if stood.rotation_path in paths:
        stand = replace(stand, mode=stood.mode, rotation=stood.rotation)
    return stand


def note(obj: bpy.types.Object, stand: Stand) -> None:
    """Remembers in the object's action where it stood before."""
    obj.animation_data.action[KEPT] = json.dumps(asdict(stand))


def forget(obj: bpy.types.Object) -> None:
    """Has it count how the object stands with its action: as it was filmed, not as it was put."""
    obj.animation_data.action[KEPT] = ""


def put_back(obj: bpy.types.Object, action: bpy.types.Action, paths: set[str]) -> None:
    """Puts an object back to where it stood before an action that moves it no longer, as far as
    that has moved it by curves of these paths; where it stays if the action is no take of ours."""
    stood = _noted(action)
    if stood is None:
        return
    if "location" in paths:
        obj.location = stood.location
    if stood.rotation_path in paths:
        _turn(obj, stood)


@contextmanager
def at_rest(obj: bpy.types.Object) -> Iterator[None]:
    """While it lasts, an object that takes of ours move stands as it did before them."""
    bpy.context.evaluated_depsgraph_get()  # what is still to be evaluated would move it again
    before = _now(obj)
    _place(obj, of(obj))
    try:
        yield
    finally:
        _place(obj, before)


def _now(obj: bpy.types.Object) -> Stand:
    path = ROTATIONS.get(obj.rotation_mode, "rotation_euler")
    return Stand(tuple(obj.location), obj.rotation_mode, tuple(getattr(obj, path)))


def _noted(action: bpy.types.Action) -> Stand | None:
    if not (text := action.get(KEPT, "")):
        return None
    kept = json.loads(text)
    return Stand(tuple(kept["location"]), kept["mode"], tuple(kept["rotation"]))


def _place(obj: bpy.types.Object, stand: Stand) -> None:
    if stand == _now(obj):
        return  # written anew, it would be evaluated anew
    obj.location = stand.location
    _turn(obj, stand)


def _turn(obj: bpy.types.Object, stand: Stand) -> None:
    mode = obj.rotation_mode
    obj.rotation_mode = stand.mode
    setattr(obj, stand.rotation_path, stand.rotation)
    if mode != stand.mode:
        obj.rotation_mode = "QUATERNION"  # Blender converts to it and from it, but no order of axes
        obj.rotation_mode = mode


def _playing(obj: bpy.types.Object) -> list[tuple[bpy.types.Action, str]]:
    """Actions that may move an object, and their slots, from the uppermost: its own, then those of
    strips on whatever tracks, where Push Down puts them."""
    animation = obj.animation_data
    if animation is None:
        return []
    users = [animation] if animation.action is not None else []
    if animation.use_nla:
        tracks = [track for track in reversed(animation.nla_tracks) if not track.mute]
        strips = [strip for track in tracks for strip in track.strips if not strip.mute]
        users += [strip for strip in strips if strip.action is not None]
    return [(user.action, compat.slot_of(user)) for user in users]
