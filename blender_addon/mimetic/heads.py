# SPDX-License-Identifier: GPL-3.0-or-later
"""Heads that muscles are attached to, as plain values: meshes at rest, and their landmarks."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix, Vector

from . import head_parts, mesh_frame, native, scene_in, world, writable
from .head_parts import HeadPart

DRAGGED = 1e-4  # metres by which a landmark lies elsewhere


@dataclass(frozen=True)
class ForeignHead:
    """A mesh to attach muscles to, as it rests."""

    name: str
    points: np.ndarray  # V x 3, object frame
    starts: np.ndarray  # first corner of each face
    corners: np.ndarray  # vertices of the faces' corners
    matrix: np.ndarray  # 4 x 4, metres from object
    landmarks: dict  # name -> vertex or place in metres
    parts: tuple[HeadPart, ...] = ()  # eyeballs, teeth, tongue that are objects of their own
    worn: tuple[
        str, ...
    ] = ()  # glasses, a hat: objects that go with the head and not with its skin

    @cached_property
    def whole(self):
        """Points, and `mimetic.character.foreign_face.Polygons`, of the head and then its parts."""
        package = native.foreign_face()
        polygons = package.Polygons(self.starts, self.corners)
        return package.with_parts(self.points, polygons, [part.mesh for part in self.parts])


def active_head(context) -> bpy.types.Object | None:
    """The active object, or the head whose landmark that is: one has just been dragged."""
    active = scene_in.active(context)
    if active is not None and active.type == "EMPTY" and active.mimetic.landmark and active.parent:
        return active.parent
    return active


def no_foreign_head(context) -> str:
    if reason := scene_in.no_start():
        return reason
    head = active_head(context)
    if head is None or head.type != "MESH":
        return "Select the head's mesh first"
    if reason := writable.no_shapes(head):
        return reason
    return "Leave the edit mode first" if context.mode != "OBJECT" else ""


def foreign_head(
    scene: bpy.types.Scene, head: bpy.types.Object, others: str = "FACE"
) -> ForeignHead:
    """The head without its sliders, and its parts; landmarks by empties, else by vertex groups.

    others: which other objects are parts, one of `head_parts.CHOICES`.
    """
    own = _read(scene, head)
    parts = () if others == "NONE" else head_parts.found(scene, head, own.points)
    if not parts or others == "ALL":
        return replace(own, parts=parts)
    package = native.foreign_face()
    polygons = package.Polygons(own.starts, own.corners)
    worn = package.WornParts(own.points, polygons, own.matrix)
    is_worn = [worn.has(part.mesh) for part in parts]
    rows = tuple(zip(parts, is_worn, strict=True))
    return replace(
        own,
        parts=tuple(part for part, has in rows if not has),
        worn=tuple(part.name for part, has in rows if has),
    )


def _read(scene: bpy.types.Scene, head: bpy.types.Object) -> ForeignHead:
    points, starts, corners = head_parts.rest_mesh(head)
    metre = scene.unit_settings.scale_length or 1.0
    matrix = np.diag([metre, metre, metre, 1.0]) @ np.array(world.matrix(head))
    places = {
        name: metre * np.array(world.matrix(mark).translation)
        for name, mark in landmark_empties(scene, head).items()
    }
    places |= {n: v for n, v in _landmark_groups(head).items() if n not in places}
    return ForeignHead(head.name, points, starts, corners, matrix, places)


def remembered_head(scene: bpy.types.Scene, head: bpy.types.Object) -> ForeignHead | None:
    """What a face's muscles were attached by, in the mesh's frame of now; None for a face of our
    own mesh."""
    if not len(head.mimetic.landmarks):
        return None
    marks = {
        mark.name: mark.vertex if _is_vertex(head, mark) else np.array(mark.place)
        for mark in head.mimetic.landmarks
    }
    own = _read(scene, head)
    parts = head_parts.remembered(head)
    return replace(own, landmarks=marks, matrix=_metres_from_object(head), parts=parts)


def _is_vertex(head: bpy.types.Object, mark) -> bool:
    """Whether a remembered landmark is its vertex: a mesh that was cut counts others."""
    return mark.vertex >= 0 and not mesh_frame.is_cut(head.mimetic.mesh_frame, head)


def _metres_from_object(head: bpy.types.Object) -> np.ndarray:
    """4 x 4: the metres in which landmarks are remembered, from the mesh's frame of now."""
    own = head.mimetic
    noted = native.array(own.metres_from_object).reshape(4, 4)
    return noted @ mesh_frame.noted_from_now(own.mesh_frame, head)


def attachment(head: bpy.types.Object) -> tuple:
    """What `remembered_head` reads beside the meshes, to be compared."""
    own = head.mimetic
    return (
        tuple(own.metres_from_object),
        tuple((mark.name, mark.vertex, *mark.place) for mark in own.landmarks),
        tuple((entry.name, *entry.head_from_part) for entry in own.parts),
    )


def no_bound_head(context) -> str:
    """Why the active mesh has no landmarks by which shapes could be made."""
    if reason := no_foreign_head(context):
        return reason
    head = active_head(context)
    if len(head.mimetic.landmarks) or landmark_empties(context.scene, head):
        return ""
    return "" if scene_in.is_face(head) else "Press Add Landmarks first, or Attach Muscles"


def bound_head(scene: bpy.types.Scene, head: bpy.types.Object, others: str = "FACE") -> ForeignHead:
    """A head with landmarks: those it was attached by, its empties, or our own mesh's; with the
    parts that it was attached with, else `others`, as for `foreign_head`."""
    if (remembered := remembered_head(scene, head)) is not None:
        return remembered
    own = foreign_head(scene, head, others)
    template = native.face_template().load_template()
    if own.landmarks or not scene_in.is_face(head) or len(own.points) != len(template.vertices):
        return own
    names = native.self_landmarks().REQUIRED
    return replace(own, landmarks={name: int(template.landmark(name)) for name in names})


def landmark_empties(scene: bpy.types.Scene, head: bpy.types.Object) -> dict:
    """Empties with landmarks' names: the head's children, or any if it has none."""
    names = frozenset(native.face_template().load_template().landmark_names)
    empties = ((obj, obj.mimetic.landmark) for obj in scene.objects if obj.type == "EMPTY")
    known = ((name or obj.name, obj) for obj, name in empties)
    marks = [(name, obj) for name, obj in known if name in names]
    own = {name: obj for name, obj in marks if obj.parent == head}
    return own or {name: obj for name, obj in marks if obj.parent is None}


def moved_landmarks(scene: bpy.types.Scene, head: bpy.types.Object | None) -> list[str]:
    """Names of the empties that were dragged since the head's muscles were attached by them."""
    if head is None or head.type != "MESH" or head.data.shape_keys is None:
        return []
    attached_by = head.mimetic.landmarks
    if not len(attached_by):
        return []
    metres = Matrix(_metres_from_object(head).tolist())
    size = metres.median_scale
    rest, from_metres = head.data.shape_keys.reference_key.points, metres.inverted_safe()
    from_world = world.matrix(head).inverted_safe()
    moved = []
    for name, empty in landmark_empties(scene, head).items():
        mark = attached_by.get(name)
        if mark is not None and mark.vertex < len(rest):
            is_vertex = _is_vertex(head, mark)
            before = rest[mark.vertex].co if is_vertex else from_metres @ Vector(mark.place)
            now = from_world @ world.matrix(empty).translation
            if (now - before).length * size < DRAGGED:
                continue
        moved.append(name)
    return moved


def _landmark_groups(head: bpy.types.Object) -> dict[str, int]:
    """Vertex groups with landmarks' names: the vertex with the largest weight."""
    names = native.face_template().load_template().landmark_names
    numbers = {group.index: group.name for group in head.vertex_groups if group.name in names}
    best: dict[str, tuple[float, int]] = {}
    if numbers:
        for vertex in head.data.vertices:
            for member in vertex.groups:
                if (name := numbers.get(member.group)) is not None:
                    best[name] = max(best.get(name, (0.0, -1)), (member.weight, vertex.index))
    return {name: vertex for name, (_, vertex) in best.items() if vertex >= 0}


def unchanged(head: ForeignHead) -> bpy.types.Object:
    """The object that was read; raises InvalidInput if it is gone or has other vertices by now."""
    obj = bpy.data.objects.get(head.name)
    if obj is None or obj.type != "MESH":
        raise native.invalid_input(
            rpt_("{head} was deleted or renamed meanwhile: begin again").format(head=head.name)
        )
    if len(obj.data.vertices) != len(head.points):
        raise native.invalid_input(
            rpt_(
                "{head} was changed meanwhile: it had {before} vertices and has {now}; begin again"
            ).format(head=head.name, before=len(head.points), now=len(obj.data.vertices))
        )
    return obj
