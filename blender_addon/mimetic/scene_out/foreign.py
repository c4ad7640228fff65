# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks of a head that is not ours, and the muscles that they give it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from .. import head_parts, native, world, writable
from . import arkit, by_hand, face, part_keys

SIZE = 0.006  # m, of an empty
MOST_FOLLOWED = 100_000  # vertices; more take longer than 5 s (docs/measured/characters.md)


@dataclass(frozen=True)
class Attached:
    hand_changes: str  # a message on keys that were changed by hand and stay, or nothing
    parts: list[str]  # objects that move along
    notes: list[str]  # why others do not


def add(context, head: bpy.types.Object, places: Mapping, doubtful: Sequence) -> None:
    """Empties at places in the world (metres), children of the head; doubtful ones are cubes."""
    stands = world.matrix(head)
    inverse = stands.inverted()
    metre = context.scene.unit_settings.scale_length or 1.0
    (collection,) = writable.collections_for(context.scene, [context.collection])
    for name, place in places.items():
        mark = bpy.data.objects.new(name, None)
        mark.mimetic.landmark = name  # Blender numbers names that are taken
        mark.empty_display_type = "CUBE" if name in doubtful else "SPHERE"
        mark.empty_display_size = SIZE / metre / max(stands.median_scale, 1e-9)
        mark.show_name = mark.show_in_front = True
        mark.parent = head
        mark.location = inverse @ (_vector(place) / metre)
        collection.objects.link(mark)


def attach(
    obj: bpy.types.Object, head, landmarks: Mapping, muscles, units: Sequence = ()
) -> Attached:
    """Shape keys of a `mimetic.foreign_face.ForeignFace`; remembers what it was made from.

    head: heads.ForeignHead; its parts get the keys that move them. units: ARKit's shapes by the
    same landmarks, for those that the head was given before.
    """
    writable.check(writable.no_shapes(obj))
    to_head = native.placement().to_head
    obj.mimetic.use_contact = True
    own = [*muscles.shapes, *muscles.groups]
    shapes, of_parts = part_keys.split(head, [*own, *units])
    sliders, groups = shapes[: len(muscles.shapes)], shapes[len(muscles.shapes) : len(own)]
    states = by_hand.look_units(obj)  # before the mesh's frame is noted anew
    hand_changes = face.set_shapes(obj, to_head(head.points), sliders, groups)
    written = arkit.write(obj, shapes[len(own) :], states)
    hand_changes.things += written.hand_changes.things
    part_keys.remove(obj, head_parts.forgotten(obj, head.parts))
    head_parts.remember(obj, head.parts)
    moved, notes = part_keys.add(obj, head, of_parts, by_hand.keys_now(obj) | written.names)
    obj.mimetic.metres_from_object = np.asarray(head.matrix, dtype=np.float64).ravel().tolist()
    stored_landmarks = obj.mimetic.landmarks
    if not len(stored_landmarks):  # later it is as the user has it
        obj.mimetic.use_live_landmarks = len(head.points) <= MOST_FOLLOWED
    stored_landmarks.clear()
    for name, place in landmarks.items():
        mark = stored_landmarks.add()
        mark.name = name
        if np.ndim(place) == 0:
            mark.vertex = int(place)
            place = head.matrix[:3, :3] @ head.points[mark.vertex] + head.matrix[:3, 3]
        mark.place = [float(x) for x in place]
    return Attached(hand_changes.text(), moved, notes)


def _vector(place):
    from mathutils import Vector

    return Vector([float(x) for x in place])
