# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact of a face animated by hand as shape keys with curves, which a file can carry."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from .. import compat, native
from . import actions, contact


@contextmanager
def with_keys(scene: bpy.types.Scene, face: bpy.types.Object) -> Iterator[bool]:
    """While it lasts, what the key that follows did in every frame is in keys with values of their
    own. Says whether there are any; if not, that key is muted, as it does nothing."""
    key = contact.key_of(face)
    if key is None:
        yield False
        return
    if face.name in contact.still_faces:  # an export within one: they are made
        yield True
        return
    shapes, frames = _shapes(scene, face)
    if not shapes:
        is_muted, key.mute = key.mute, True
        try:
            yield False
        finally:
            key.mute = is_muted
        return
    # All that share the mesh: one that goes on following would write the key's points
    keys = face.data.shape_keys
    still = {o.name for o in bpy.data.objects if getattr(o.data, "shape_keys", None) == keys}
    made: list[str] = []
    try:
        contact.still_faces.update(still)
        _add(face, shapes, frames, made)
        yield True
    finally:
        contact.still_faces.difference_update(still)
        _take_off(face, made)
        keys.update_tag()


def _shapes(scene: bpy.types.Scene, face: bpy.types.Object):
    """Shapes in the object's frame, with a value a frame."""
    keys, current_frame = face.data.shape_keys, scene.frame_current_final
    holder = compat.curves(keys)
    frames = np.array([scene.frame_current])
    if holder is not None and len(holder.fcurves):
        ends = np.array([curve.range() for curve in holder.fcurves])
        frames = np.arange(np.floor(ends[:, 0].min()), np.ceil(ends[:, 1].max()) + 1).astype(int)
    basis = contact.points_of(keys.reference_key)
    corrections = {}
    try:
        for i, frame in enumerate(frames):
            scene.frame_set(int(frame))
            offsets = contact.points_of(contact.key_of(face)) - basis
            if offsets.any():
                corrections[i] = offsets
    finally:
        scene.frame_set(int(np.floor(current_frame)), subframe=current_frame % 1)
    everywhere = np.arange(len(basis))
    parts = native.contact_shapes()
    shapes = parts.shapes_of_corrections(corrections, len(frames), everywhere, len(basis))
    return shapes, frames


def _add(face: bpy.types.Object, shapes, frames, made: list[str]) -> None:
    """The first shape takes the place of the key that follows: no other's number changes.

    made: gets the names of the keys, each once its curve is there.
    """
    keys = face.data.shape_keys
    basis = contact.points_of(keys.reference_key)
    names = [contact.KEY, *(f"{contact.KEY} {i + 2}" for i in range(len(shapes) - 1))]
    holder = compat.curves(keys)
    for name, shape in zip(names, shapes, strict=True):
        key = keys.key_blocks.get(name) or face.shape_key_add(name=name, from_mix=False)
        curve = None
        if holder is not None and len(frames) > 1:
            curve = compat.new_curve(holder, key.path_from_id("value"), 0, shape.group)
        made.append(name)
        key.slider_min, key.slider_max = -1.0, 1.0
        key.value = shape.values[0]
        key.points.foreach_set("co", (basis + shape.offsets).astype(np.float32).ravel())
        if curve is not None:
            actions.fill(curve, frames, shape.values, actions.LINEAR)


def _take_off(face: bpy.types.Object, names: list[str]) -> None:
    keys = face.data.shape_keys
    holder = compat.curves(keys)
    for name in names:
        key = keys.key_blocks[name]
        if holder is not None and (curve := holder.fcurves.find(key.path_from_id("value"))):
            holder.fcurves.remove(curve)
        if name != contact.KEY:
            face.shape_key_remove(key)
    if contact.KEY in names:
        key = keys.key_blocks[contact.KEY]
        key.slider_min, key.value = 0.0, 1.0
        contact.rest(face)
