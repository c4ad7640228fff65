# SPDX-License-Identifier: GPL-3.0-or-later
"""The other meshes of a character that have shape keys of the head's names, or known ones: teeth,
tongue, eyes, brows. What plays the head's keys plays theirs by the same values."""

from __future__ import annotations

import bpy

from .. import head_parts, native, world, writable


def of(head: bpy.types.Object) -> list[bpy.types.Object]:
    """Meshes with shape keys that an armature of the head's moves, that hang on the head, or, on
    what it hangs on, lie inside of its box; not those whose keys could not be written."""
    if head.type != "MESH":
        return []
    rigs = armatures(head)
    others = {obj for scene in head.users_scene for obj in scene.objects if _has_keys(obj, head)}
    carried = [obj for obj in others if _is_carried(obj, head, rigs)]
    return sorted(carried, key=lambda obj: obj.name)


def remember(head: bpy.types.Object, others: list[bpy.types.Object]) -> None:
    """Notes which meshes a take is on beside the head's: `remembered` gives them."""
    known = {entry.part for entry in head.mimetic.companions}
    for obj in others:
        if obj not in known:
            entry = head.mimetic.companions.add()
            entry.name, entry.part = obj.name, obj


def remembered(head: bpy.types.Object) -> dict[str, bpy.types.Key]:
    """Shape keys of the meshes that takes were put on, by their names then."""
    return {
        entry.name: keys
        for entry in head.mimetic.companions
        if entry.part is not None and (keys := getattr(entry.part.data, "shape_keys", None))
    }


def _has_keys(obj: bpy.types.Object, head: bpy.types.Object) -> bool:
    return (
        obj.type == "MESH"
        and obj != head
        and obj.data != head.data
        and obj.data.shape_keys is not None
        and obj.data.shape_keys.use_relative
        and not len(obj.mimetic.shapes)
        and not writable.no_sliders(obj)
    )


def _is_carried(obj, head, rigs: set[bpy.types.Object]) -> bool:
    if rigs & armatures(obj):
        return True
    above = obj.parent
    while above is not None:
        if above == head:
            return True
        above = above.parent
    return head.parent is not None and obj.parent == head.parent and _lies_in(obj, head)


def armatures(obj: bpy.types.Object) -> set[bpy.types.Object]:
    """Those that deform or carry an object."""
    rigs = {m.object for m in obj.modifiers if m.type == "ARMATURE"}
    above = obj.parent
    while above is not None:
        if above.type == "ARMATURE":
            rigs.add(above)
        above = above.parent
    return rigs - {None}


def _lies_in(obj: bpy.types.Object, head: bpy.types.Object) -> bool:
    matrix = world.matrix(head).inverted_safe() @ world.matrix(obj)
    if abs(matrix.determinant()) == 0:
        return False
    points, *_ = head_parts.rest_mesh(head)
    part = head_parts.part_mesh(obj, native.array(matrix))
    return native.foreign_face().lies_in(points, part)
