# SPDX-License-Identifier: GPL-3.0-or-later
"""The face: an object with a shape key for every muscle, for jaw and lids, and for detail.

Shape keys of whole groups come last. Their values add to those of the muscles, so that a slider
of a group and a baked curve of a muscle never write to the same place.
"""

from __future__ import annotations

import bpy
import numpy as np

from .. import native
from . import contact

BASIS = "Basis"


def ensure(scene, performance, shapes, groups, subdivision: int) -> bpy.types.Object:
    """The scene's face with the performance's surface; a new one if the topology differs."""
    face = scene.mimetic.face
    if face is None or face.name not in scene.objects or not _has_faces(face, performance.faces):
        face = new(performance.neutral_vertices, performance.faces)
        scene.collection.objects.link(face)
        scene.mimetic.face = face
    set_shapes(face, performance.neutral_vertices, shapes, groups)
    subdivide(face, subdivision)
    return face


def _has_faces(face, faces) -> bool:
    mesh = face.data
    if face.type != "MESH" or len(mesh.loops) != faces.size:
        return False
    corners = np.empty(faces.size, dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return bool((corners == faces.reshape(-1)).all())


def new(neutral_vertices, faces) -> bpy.types.Object:
    """A face without shapes, in no collection yet; V x 3 metres in the head frame, F x 4."""
    mesh = bpy.data.meshes.new("Face")
    vertices = native.part("placement").to_object(neutral_vertices)
    mesh.from_pydata(vertices, [], faces.tolist())
    mesh.shade_smooth()
    face = bpy.data.objects.new("Face", mesh)
    face.rotation_mode = "QUATERNION"
    return face


def set_shapes(face, neutral_vertices, shapes, groups) -> None:
    """Gives the face its shape keys, `mimetic.shapes.Shape`: shapes, then sliders of groups."""
    to_object = native.part("placement").to_object
    keys = face.data.shape_keys
    if keys is None:
        face.shape_key_add(name=BASIS, from_mix=False)
        keys = face.data.shape_keys
        keys.name = "Face"
    neutral = to_object(neutral_vertices)
    basis = keys.reference_key
    _place(basis, neutral)
    # The mesh's own vertices follow its first key; foreach_set on keys alone leaves them behind
    face.data.vertices.foreach_set("co", neutral.astype(np.float32).reshape(-1))
    earlier = {listed.name for listed in (*face.mimetic.shapes, *face.mimetic.groups)}
    levels = _take_off_last(face)
    for shape in (*shapes, *groups):
        key = keys.key_blocks.get(shape.name)
        if key is None:
            key = face.shape_key_add(name=shape.name, from_mix=False)
            levels.setdefault(shape.name, 0.0)  # Blender 5.2 starts at 1
        key.relative_key = basis
        key.slider_min = shape.lowest
        key.slider_max = shape.highest
        key.value = levels.get(shape.name, key.value)
        _place(key, neutral + to_object(shape.offsets))
    if face.mimetic.use_contact:
        contact.ensure_key(face)
    named = {shape.name for shape in (*shapes, *groups)}
    for key in keys.key_blocks:  # what an earlier take moved and this one does not
        if key.name in earlier - named:
            key.value = 0.0
    _list(face.mimetic.shapes, shapes)
    _list(face.mimetic.groups, groups)
    face.data.update()


def _take_off_last(face) -> dict[str, float]:
    """Removes the keys of groups and contact, which are made again behind all others; returns the
    values of the groups."""
    blocks = face.data.shape_keys.key_blocks
    if key := contact.key_of(face):
        face.shape_key_remove(key)
    found = [blocks[listed.name] for listed in face.mimetic.groups if listed.name in blocks]
    levels = {key.name: key.value for key in found}
    for name in levels:
        face.shape_key_remove(blocks[name])
    return levels


def _list(listed, shapes) -> None:
    listed.clear()
    for shape in shapes:
        entry = listed.add()
        entry.name, entry.group = shape.name, shape.group


def _place(key, points) -> None:
    key.points.foreach_set("co", points.astype(np.float32).reshape(-1))


def subdivide(face, levels: int) -> None:
    modifier = face.modifiers.get("Subdivision")
    if modifier is None:
        if levels == 0:
            return
        modifier = face.modifiers.new("Subdivision", "SUBSURF")
        modifier.boundary_smooth = "PRESERVE_CORNERS"
    modifier.levels = levels
    modifier.render_levels = max(levels, min(levels + 1, 2))
