# SPDX-License-Identifier: GPL-3.0-or-later
"""The shape key that keeps lips and lids of a face apart as its sliders move.

Its value stays; its points follow. It is the last of the keys, so that no other's number changes
when it comes or goes.
"""

from __future__ import annotations

import bpy
import numpy as np

KEY = "contact"
still_faces: set[str] = set()  # names of faces whose key does not follow now
resting_faces: set[str] = set()  # of faces whose key was put to rest and has not followed since


def key_of(face: bpy.types.Object) -> bpy.types.ShapeKey | None:
    keys = face.data.shape_keys
    return keys.key_blocks.get(KEY) if keys else None


def ensure_key(face: bpy.types.Object) -> bpy.types.ShapeKey:
    """The key, at rest if it is new."""
    key = key_of(face)
    if key is None:
        key = face.shape_key_add(name=KEY, from_mix=False)
        key.relative_key = face.data.shape_keys.reference_key
        key.value = 1.0
        rest(face)
    return key


def rest(face: bpy.types.Object) -> None:
    """Puts the key to rest: what the face's sliders do has to be looked at again."""
    place(face, None, None)
    resting_faces.add(face.name)


def place(face: bpy.types.Object, new_points, correction) -> None:
    """Puts the key's points where the face rests, but for W moved vertices (W x 3 from there)."""
    keys = face.data.shape_keys
    points = points_of(keys.reference_key)
    if correction is not None:
        points[new_points] += correction
    key_of(face).points.foreach_set("co", points.ravel())
    keys.update_tag()


def points_of(key: bpy.types.ShapeKey) -> np.ndarray:
    """V x 3 float32, object frame."""
    points = np.empty(3 * len(key.points), dtype=np.float32)
    key.points.foreach_get("co", points)
    return points.reshape(-1, 3)
