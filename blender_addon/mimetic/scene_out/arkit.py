# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's 52 shapes as shape keys of a head; its other keys stay as they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import bpy

from .. import writable
from . import by_hand, contact, face, part_keys, renamed_keys
from .by_hand import HandChanges, KeyState


@dataclass(frozen=True)
class Written:
    names: dict[str, str]  # of the keys, by shape
    added: list[str]  # shapes of these that were not there before
    kept: list[str]  # keys of such names that are the user's own, and stay
    hand_changes: HandChanges = field(default_factory=HandChanges)  # that stay
    parts: list[str] = field(default_factory=list)  # objects that move along
    notes: list[str] = field(default_factory=list)  # why others do not


def give(obj: bpy.types.Object, head, shapes: Sequence) -> Written:
    """Gives a head and its parts a shape key for each of its `mimetic.shapes.Shape`.

    head: heads.ForeignHead.
    """
    own, of_parts = part_keys.split(head, shapes)
    written = write(obj, own)
    parts, notes = part_keys.add(obj, head, of_parts, written.names)
    return replace(written, parts=parts, notes=notes)


def write(
    obj: bpy.types.Object, shapes: Sequence, known: Mapping[str, KeyState] | None = None
) -> Written:
    """Gives a head a shape key for each `mimetic.shapes.Shape`.

    One that it was given before is written again, but for what was changed by hand. known: those
    alone are written, as `by_hand.look_units` saw them.
    """
    writable.check(writable.no_shapes(obj))
    if obj.data.shape_keys is None:
        obj.shape_key_add(name=face.BASIS, from_mix=False)
    blocks = obj.data.shape_keys.key_blocks
    active = obj.active_shape_key_index
    states = dict(by_hand.look_units(obj) if known is None else known)
    renamed_keys.follow(obj)  # while the names of before are known
    kept, added = [], []
    for shape in shapes:
        if shape.name in states or known is not None:
            continue
        if shape.name in blocks:
            kept.append(shape.name)
            continue
        face.add_key(obj, shape.name)
        states[shape.name] = KeyState(shape.name)
        added.append(shape.name)
    own = [shape for shape in shapes if shape.name in states]
    written = Written({shape.name: states[shape.name].key for shape in own}, added, kept)
    entries = face.list_shapes(obj.mimetic.units, own)
    for entry, shape in zip(entries, own, strict=True):
        face.write_key(obj, entry, shape, states[shape.name], written.hand_changes)
    if added:
        last = [entry.name for entry in obj.mimetic.groups] + [contact.KEY]
        face.move_to_end(obj, [name for name in last if name in blocks])
        obj.active_shape_key_index = active
    by_hand.remember_places(obj)
    obj.data.update()
    return written
