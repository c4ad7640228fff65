# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of takes, and the shape keys and bones that they move by name. Blender follows a new name
in actions that are assigned or in the NLA; those of takes that wait keep the old one."""

from __future__ import annotations

import re
from collections.abc import Mapping

import bpy

from .. import compat, native
from . import by_hand

KEYS = "KEYS"  # the part of a take that is on the mesh's own shape keys
MOVED = re.compile(r'key_blocks\["((?:[^"\\]|\\.)*)"\]')
BONE = re.compile(r'pose\.bones\["((?:[^"\\]|\\.)*)"\]')


def follow(obj: bpy.types.Object) -> None:
    """Has all takes of a face move the keys that they moved before these were renamed, as far as
    they are known; and remembers the names that keys have now.

    To be called before a take begins or ceases to play, and before other names are remembered.
    """
    keys = obj.data.shape_keys if obj.type == "MESH" else None
    if keys is None:
        return
    now, shapes = by_hand.all_keys_now(obj), by_hand.shapes_by_name(obj)
    for row in obj.mimetic.takes:
        curves = _curves_of(row.parts[KEYS]) if KEYS in row.parts else []
        paths = {curve.data_path for curve in curves}
        for curve in curves:
            name = key_of(curve.data_path)
            if not name or name in keys.key_blocks or (shape := shapes.get(name)) not in now:
                continue
            path = _renamed(curve.data_path, now[shape])
            if path not in paths:
                curve.data_path = path
                paths.add(path)
    by_hand.remember_names(obj)


def gone(row, blocks: Mapping[str, bpy.types.ID]) -> list[str]:
    """Names of shape keys that a take moves, and what it plays on no longer has.

    blocks: what each part of the take moves. Contact and detail are made anew by every bake.
    """
    names = []
    for part in row.parts:
        keys = blocks.get(part.name)
        # A mesh whose keys were applied has none left; another object may be gone itself
        if isinstance(keys, bpy.types.Key) or (keys is None and part.name == KEYS):
            held = keys.key_blocks if keys is not None else ()
            moved = (key_of(curve.data_path) for curve in _curves_of(part) if not _is_rest(curve))
            names += [name for name in moved if name and name not in held]
    return list(dict.fromkeys(names))


def gone_bones(row, blocks: Mapping[str, bpy.types.ID]) -> dict[str, list[str]]:
    """Names of bones that a take moves, and what it plays on no longer has, by that one's name."""
    found = {}
    for part in row.parts:
        armature = blocks.get(part.name)
        if not isinstance(armature, bpy.types.Object) or armature.pose is None:
            continue
        moved = (_named(BONE, curve.data_path) for curve in _curves_of(part))
        if names := [name for name in moved if name and name not in armature.pose.bones]:
            found[armature.name] = list(dict.fromkeys(names))
    return found


def lasting_path(path: str, shapes: Mapping[str, str]) -> str:
    """A curve's path with a key's shape, of `by_hand.shapes_by_name`, instead of its name."""
    return _renamed(path, shapes[name]) if (name := key_of(path)) in shapes else path


def key_of(path: str) -> str:
    """Name of the shape key that a curve with a path moves, or nothing."""
    return _named(MOVED, path)


def without_bone(path: str) -> str:
    """A curve's path without the name of the bone that it moves, if it moves one."""
    return BONE.sub("pose.bones", path, count=1)


def _named(pattern: re.Pattern, path: str) -> str:
    found = pattern.match(path)
    return bpy.utils.unescape_identifier(found[1]) if found else ""


def _renamed(path: str, name: str) -> str:
    return f'key_blocks["{bpy.utils.escape_identifier(name)}"]' + path[MOVED.match(path).end() :]


def _curves_of(part) -> list[bpy.types.FCurve]:
    return compat.curves_of(part.action, part.slot_now) if part.action else []


def _is_rest(curve: bpy.types.FCurve) -> bool:
    parts = native.shapes()
    return curve.group is not None and curve.group.name in (parts.CONTACT, parts.DETAIL)
