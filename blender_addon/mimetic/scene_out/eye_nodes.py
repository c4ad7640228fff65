# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyeballs as objects of their own that turn, for files of programs that aim eyes by nodes."""

from __future__ import annotations

import bmesh
import bpy
import numpy as np

from .. import compat, native, scene_in
from . import actions

NAMES = ("Eye.L", "Eye.R")


def split(scene: bpy.types.Scene, performance, footage, take: str) -> list[bpy.types.Object]:
    """Takes the eyeballs off the scene's baked face, and gives each its curves of turns.

    footage: the clip of the performance, or None. The face stays what moves them: it is their
    parent. The shapes that turned the eyeballs go. Raises what bad input raises for a performance
    without gaze.
    """
    parts = native.gaze_shapes()
    if not parts.has_gaze(performance):
        raise native.invalid_input(
            "the performance has no gaze to turn eyes by: capture the clip again, or leave "
            "--eyes out"
        )
    face, eye_of = scene.mimetic.face, np.asarray(performance.eye_of_vertex)
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    pivots = native.placement().to_object(np.asarray(performance.eye_centers))
    angles = parts.gaze_of(performance)
    eyes = []
    for number, (name, pivot) in enumerate(zip(NAMES, pivots, strict=True)):
        eye = bpy.data.objects.new(name, face.data.copy())
        face.users_collection[0].objects.link(eye)
        eye.shape_key_clear()
        keep(eye.data, eye_of == number + 1)
        eye.data.transform(_shift(-pivot))
        eye.parent, eye.location = face, pivot
        yaw, pitch = angles[:, 2 * number], angles[:, 2 * number + 1]
        rows = parts.eye_quaternions(yaw, pitch)
        eye.rotation_mode = "QUATERNION"
        holder = actions.new_take(eye, f"{take} {name}")
        actions.key_columns(holder, "rotation_quaternion", "Gaze", frames, rows)
        eyes.append(eye)
    _drop_turns(face)
    keep(face.data, eye_of == 0)
    return eyes


def keep(mesh: bpy.types.Mesh, is_kept: np.ndarray) -> None:
    """Deletes all other vertices, of shape keys too."""
    edited = bmesh.new()
    edited.from_mesh(mesh)
    others = [vertex for vertex, kept in zip(edited.verts, is_kept, strict=True) if not kept]
    bmesh.ops.delete(edited, geom=others, context="VERTS")
    edited.to_mesh(mesh)
    edited.free()
    mesh.update()


def _shift(offset):
    from mathutils import Matrix

    return Matrix.Translation([float(value) for value in offset])


def _drop_turns(face: bpy.types.Object) -> None:
    """The shape keys that turn nothing but eyeballs, and their curves."""
    keys = face.data.shape_keys
    for name in native.gaze_shapes().TURNS:
        for side in "LR":
            if (key := keys.key_blocks.get(f"{name}.{side}")) is None:
                continue
            holder = compat.curves(keys)
            if holder and (curve := holder.fcurves.find(key.path_from_id("value"))):
                holder.fcurves.remove(curve)
            face.shape_key_remove(key)
