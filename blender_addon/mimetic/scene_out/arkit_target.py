# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character's ARKit shapes, for a file of those names alone.

The character's own shapes of known names are ARKit's; those that it lacks are made of its muscles.
Then the muscles' shapes go. Changes the character for good: for a copy of its file.
"""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, heads, native, scene_in, writable
from . import (
    actions,
    arkit,
    by_hand,
    contact,
    control_object,
    control_removal,
    own_controls,
    own_keys,
    part_keys,
)

MOST_NAMED = 6


def bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    character: bpy.types.Object,
    footage: bpy.types.MovieClip | None = None,
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> own_controls.BakeSummary:
    """As `own_controls.bake`, on ARKit's names. Raises what bad input raises where the character
    has none of the 52 and no muscles to make them of."""
    if character.type != "MESH":
        raise native.invalid_input(
            rpt_("{name} is no mesh: --names arkit is of the mesh of a head").format(
                name=character.name
            )
        )
    writable.check(writable.no_shapes(character))
    if control_object.of(character) is not None:
        control_removal.remove(scene, character, use_curves=False)
    _rename(character)
    has_muscles = scene_in.is_face(character)
    notes = _make(scene, character) if has_muscles else []
    found = native.control_names().units_of(
        name for _, keys in own_keys.holders(character) for name in keys
    )
    if not found:
        raise native.invalid_input(
            rpt_(
                "{name} has no shape of ARKit's 52 names that is free to move, and no muscles to "
                "make them of: attach muscles to it (mimetic shapes makes the 52 alone), or leave "
                "--names out"
            ).format(name=character.name)
        )
    played = native.playing().play_units(performance, found)
    _free_limits(character, played.names)
    summary = own_controls.bake(
        *(scene, performance, take, character, played, footage, True, tolerance, by_phases)
    )
    drop_muscles(character)
    texts = (summary.text, _missing(character, played.names, has_muscles), *notes)
    return own_controls.BakeSummary(
        summary.first, summary.last, summary.num_curves, "; ".join(filter(None, texts))
    )


def drop_muscles(head: bpy.types.Object) -> None:
    """Takes off the head and its parts all keys that were attached with its muscles."""
    head.mimetic.use_contact = False
    keys = head.data.shape_keys
    own = {name for name in by_hand.keys_now(head).values() if name in keys.key_blocks}
    own |= {contact.KEY} & set(keys.key_blocks.keys())
    paths = {keys.key_blocks[name].path_from_id("value") for name in own}
    for part in (entry.part for entry in head.mimetic.parts):
        if part is not None and (of_part := getattr(part.data, "shape_keys", None)):
            by_path = {key.path_from_id("value"): key.name for key in of_part.key_blocks}
            drop(
                part,
                [
                    by_path[driver.data_path]
                    for driver, source, path in part_keys.drivers_of(of_part)
                    if source == keys and path in paths and driver.data_path in by_path
                ],
            )
    head.mimetic.shapes.clear()
    head.mimetic.groups.clear()
    drop(head, own)


def drop(obj: bpy.types.Object, names) -> None:
    """Removes shape keys with what moves them."""
    keys = obj.data.shape_keys
    holder, driven = compat.curves(keys), actions.driver_paths(keys)
    for name in names:
        key = keys.key_blocks[name]
        path = key.path_from_id("value")
        if path in driven:
            keys.driver_remove(path)
        if holder is not None:
            actions.clear(holder, path)
        obj.shape_key_remove(key)
    obj.data.update()


def _rename(character: bpy.types.Object) -> None:
    """Own shapes that are one of ARKit's under another name get that name."""
    for obj, keys in own_keys.holders(character):
        if not keys:
            continue
        blocks = obj.data.shape_keys.key_blocks
        for unit, name in native.control_names().units_of(keys).items():
            if unit not in blocks:
                blocks[name].name = unit


def _make(scene: bpy.types.Scene, head: bpy.types.Object) -> list[str]:
    """Makes the shapes that a head with muscles lacks; returns what to know of them."""
    blocks = head.data.shape_keys.key_blocks
    if all(unit in blocks for unit in native.unit_fit().unit_order()):
        return []
    own = heads.bound_head(scene, head)
    face = native.foreign_face().attach_face(*own.whole, own.landmarks, own.matrix)
    shapes, notes = face.unit_shapes()
    written = arkit.give(head, own, shapes)
    return [
        rpt_("{count} shapes made of its muscles").format(count=len(written.added)),
        *notes,
        *written.notes,
    ]


def _free_limits(character: bpy.types.Object, names) -> None:
    """A value of 1 is full, as those who read ARKit's names take it."""
    for _, keys in own_keys.holders(character):
        for name in names:
            if (key := keys.get(name)) is not None:
                key.slider_min, key.slider_max = min(key.slider_min, 0.0), max(key.slider_max, 1.0)


def _missing(character: bpy.types.Object, names, has_muscles: bool) -> str:
    lacking = [unit for unit in native.unit_fit().unit_order() if unit not in names]
    if not lacking:
        return ""
    more = len(lacking) - MOST_NAMED
    listed = ", ".join(lacking[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
    text = (
        rpt_("drivers hold {shapes} of {name}, or they are muted")
        if has_muscles
        else rpt_("{name} has no {shapes}: muscles attached to it would make them")
    )
    return text.format(name=character.name, shapes=listed)
