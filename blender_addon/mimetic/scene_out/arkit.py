# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's 52 shapes as shape keys of a head; its other keys stay as they are."""

from __future__ import annotations

import bpy

from .. import native, writable
from . import by_hand, contact
from .face import BASIS, add_key, move_to_end, place_key


def add(obj: bpy.types.Object, shapes) -> tuple[list[str], list[str]]:
    """Adds a shape key for each `mimetic.shapes.Shape` that has none of its name.

    Returns the names of the new ones and of those that were there before, which stay.
    """
    writable.check(writable.no_shapes(obj))
    if obj.data.shape_keys is None:
        obj.shape_key_add(name=BASIS, from_mix=False)
    keys = obj.data.shape_keys
    rest = contact.points_of(keys.reference_key)
    active = obj.active_shape_key_index
    added, kept = [], []
    for shape in shapes:
        if shape.name in keys.key_blocks:
            kept.append(shape.name)
            continue
        key = add_key(obj, shape.name)
        key.slider_min, key.slider_max = shape.lowest, shape.highest
        place_key(key, rest + native.placement().to_object(shape.offsets))
        added.append(shape.name)
    last = [entry.name for entry in obj.mimetic.groups] + [contact.KEY]
    move_to_end(obj, [name for name in last if name in keys.key_blocks])
    obj.active_shape_key_index = active
    by_hand.remember_places(obj)
    obj.data.update()
    return added, kept
