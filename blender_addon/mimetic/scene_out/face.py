# SPDX-License-Identifier: GPL-3.0-or-later
"""The face: an object with a shape key for every muscle, for jaw and lids, and for detail."""

from __future__ import annotations

import bpy
import numpy as np

from .. import native

BASIS = "Basis"


def ensure(scene, performance, shapes, subdivision: int) -> bpy.types.Object:
    """The scene's face with the performance's surface; a new one if the topology differs."""
    face = scene.mimetic.face
    if face is None or face.name not in scene.objects or not _has_faces(face, performance.faces):
        face = _new(scene, performance)
        scene.mimetic.face = face
    _set_shapes(face, performance.neutral_vertices, shapes)
    _subdivide(face, subdivision)
    return face


def _has_faces(face, faces) -> bool:
    mesh = face.data
    if face.type != "MESH" or len(mesh.loops) != faces.size:
        return False
    corners = np.empty(faces.size, dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return bool((corners == faces.reshape(-1)).all())


def _new(scene, performance) -> bpy.types.Object:
    mesh = bpy.data.meshes.new("Face")
    vertices = native.part("placement").to_object(performance.neutral_vertices)
    mesh.from_pydata(vertices, [], performance.faces.tolist())
    mesh.shade_smooth()
    face = bpy.data.objects.new("Face", mesh)
    face.rotation_mode = "QUATERNION"
    scene.collection.objects.link(face)
    return face


def _set_shapes(face, neutral_vertices, shapes) -> None:
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
    for shape in shapes:
        key = keys.key_blocks.get(shape.name)
        if key is None:
            key = face.shape_key_add(name=shape.name, from_mix=False)
        key.relative_key = basis
        key.slider_min = shape.lowest
        key.slider_max = shape.highest
        _place(key, neutral + to_object(shape.offsets))
    named = {shape.name for shape in shapes}
    for key in keys.key_blocks:  # what an earlier take moved and this one does not
        if key.name not in named:
            key.value = 0.0
    face.data.update()


def _place(key, points) -> None:
    key.points.foreach_set("co", points.astype(np.float32).reshape(-1))


def _subdivide(face, levels: int) -> None:
    modifier = face.modifiers.get("Subdivision")
    if modifier is None:
        if levels == 0:
            return
        modifier = face.modifiers.new("Subdivision", "SUBSURF")
        modifier.boundary_smooth = "PRESERVE_CORNERS"
    modifier.levels = levels
    modifier.render_levels = max(levels, min(levels + 1, 2))
