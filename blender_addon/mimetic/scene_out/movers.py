# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves an object in the course of the scene besides its own curves."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from .. import compat
from . import actions

PLACE = ("location", "rotation", "scale", "delta_")  # how an object's own paths begin
BONES = "pose.bones"


def animated_mover(obj: bpy.types.Object) -> str:
    """Name of an object that moves `obj` and is animated, or the empty string.

    Those are its parents and what its constraints follow, and theirs in turn.
    """
    pending, seen = [obj], set()
    while pending:
        current = pending.pop(0)
        seen.add(current)
        for mover, with_bones in _movers(current):
            if is_animated(mover, with_bones):
                return mover.name
            if mover not in seen:
                pending.append(mover)
    return ""


def is_animated(obj: bpy.types.Object, with_bones: bool = False) -> bool:
    """Whether actions, strips or drivers move an object, or bones of it too."""
    begins = (*PLACE, BONES) if with_bones else PLACE
    return any(path.startswith(begins) for path in _paths(obj))


def _movers(obj: bpy.types.Object) -> Iterator[tuple[bpy.types.Object, bool]]:
    """Each object that an object hangs on or follows, and whether it is by one of its bones."""
    if obj.parent is not None:
        yield obj.parent, obj.parent_type == "BONE"
    for constraint in obj.constraints:
        target = getattr(constraint, "target", None)
        if target is not None and not constraint.mute:
            yield target, bool(getattr(constraint, "subtarget", ""))


def _paths(obj: bpy.types.Object) -> set[str]:
    paths, animation = actions.driver_paths(obj), obj.animation_data
    if animation is None:
        return paths
    strips = [
        strip
        for track in animation.nla_tracks
        if not track.mute
        for strip in track.strips
        if not strip.mute
    ]
    for user in (animation, *(strips if animation.use_nla else ())):
        if user.action is not None:
            paths |= compat.paths_of(user.action, compat.slot_of(user))
    return paths
