# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that belong to a head: eyeballs, teeth, tongue, lashes that are meshes of their own; and
those that it wears, glasses and hats, which go with it and not with its skin."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_

from . import mesh_frame, native, world, writable

MOST_VERTICES = 50_000  # of one part: what is finer is hair or cloth
CHOICES = (
    (
        "FACE",
        "Parts of the Face",
        "Eyeballs, teeth, tongue, lashes, a beard: what lies behind the skin or on it. What the "
        "head wears before it, glasses or a hat, goes with the head alone",
    ),
    ("ALL", "All", "What the head wears is moved by its skin, too"),
    ("NONE", "None", "The head's own mesh alone"),
)


@dataclass(frozen=True)
class HeadPart:
    """A part as it rests. still: why nothing can move it, or nothing."""

    name: str
    library: str  # path of the file that it is linked from, or nothing
    mesh: object  # mimetic.character.foreign_face.PartMesh
    still: str


def found(scene: bpy.types.Scene, head: bpy.types.Object, points) -> tuple[HeadPart, ...]:
    """Meshes that are shown, rendered, small and inside of the head's box, by their names."""
    lies_in = native.foreign_face().lies_in
    from_world = world.matrix(head).inverted_safe()
    parts = []
    for obj in sorted(scene.objects, key=lambda obj: obj.name):
        if _may_be_part(obj, head):
            part = _part(obj, native.array(from_world @ world.matrix(obj)))
            if lies_in(points, part.mesh):
                parts.append(part)
    return tuple(parts)


def remembered(head: bpy.types.Object) -> tuple[HeadPart, ...]:
    """Those that the head's muscles were attached with, as far as they are there."""
    head_now = mesh_frame.now_from_noted(head.mimetic.mesh_frame, head)
    return tuple(
        _part(entry.part, head_now @ _head_from_part(entry))
        for entry in head.mimetic.parts
        if entry.part is not None and entry.part.type == "MESH"
    )


def _head_from_part(entry) -> np.ndarray:
    """4 x 4: where the head's mesh was when the part was remembered, from the part's of now."""
    noted = native.array(entry.head_from_part).reshape(4, 4)
    return noted @ mesh_frame.noted_from_now(entry.mesh_frame, entry.part)


def remember(head: bpy.types.Object, parts: tuple[HeadPart, ...]) -> None:
    entries = head.mimetic.parts
    entries.clear()
    for part in parts:
        if (obj := object_of(part)) is not None:
            entry = entries.add()
            entry.name, entry.part = part.name, obj
            entry.head_from_part = part.mesh.head_from_part.ravel().tolist()
            mesh_frame.note(entry.mesh_frame, part.mesh.points)


def forgotten(head: bpy.types.Object, parts: tuple[HeadPart, ...]) -> list[bpy.types.Object]:
    """Objects that the head's muscles were attached with before and are not now."""
    own = {object_of(part) for part in parts}
    before = [entry.part for entry in head.mimetic.parts if entry.part is not None]
    return [obj for obj in before if obj not in own and obj.type == "MESH"]


def object_of(part: HeadPart) -> bpy.types.Object | None:
    """The object that was read; None if it is gone, or has other vertices by now."""
    obj = bpy.data.objects.get((part.name, part.library or None))
    is_same = (
        obj is not None and obj.type == "MESH" and len(obj.data.vertices) == len(part.mesh.points)
    )
    return obj if is_same else None


def rest_mesh(obj: bpy.types.Object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """V x 3 points without shape keys, first corners of the polygons, vertices of all corners."""
    mesh = obj.data
    starts = np.empty(len(mesh.polygons), dtype=np.int32)
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    mesh.polygons.foreach_get("loop_start", starts)
    mesh.loops.foreach_get("vertex_index", corners)
    vertices = mesh.shape_keys.reference_key.points if mesh.shape_keys else mesh.vertices
    points = np.empty(3 * len(vertices), dtype=np.float32)
    vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(np.float64), starts, corners


def _may_be_part(obj: bpy.types.Object, head: bpy.types.Object) -> bool:
    return (
        obj.type == "MESH"
        and obj != head
        and obj.data != head.data
        and obj.visible_get()
        and not obj.hide_render
        and not len(obj.mimetic.shapes)
        and len(obj.data.polygons) > 0
        and len(obj.data.vertices) <= MOST_VERTICES
        and abs(world.matrix(obj).determinant()) > 0
    )


def _part(obj: bpy.types.Object, head_from_part) -> HeadPart:
    library = obj.library.filepath if obj.library else ""
    return HeadPart(obj.name, library, part_mesh(obj, head_from_part), _no_keys(obj))


def part_mesh(obj: bpy.types.Object, head_from_part):
    """A `mimetic.character.foreign_face.PartMesh` of an object, as it rests."""
    parts = native.foreign_face()
    points, starts, corners = rest_mesh(obj)
    # In single precision, as the head keeps it
    matrix = np.asarray(head_from_part, dtype=np.float32).astype(np.float64)
    return parts.PartMesh(points, parts.Polygons(starts, corners), matrix)


def _no_keys(obj: bpy.types.Object) -> str:
    if reason := writable.no_shapes(obj):
        return reason
    keys = obj.data.shape_keys
    if keys is not None and not keys.use_relative:
        return iface_(
            "{name}'s shape keys are absolute: only relative ones can be combined"
        ).format(name=obj.name)
    return writable.no_own_mesh(obj)
