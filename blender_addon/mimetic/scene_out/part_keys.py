# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys of eyeballs, teeth and tongue that are objects of their own.

Each follows the head's key of the same shape by a driver, so that whatever moves the head's (a
take, a slider, a control object, a live face) moves them as well.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import head_parts, native, writable
from .contact import points_of
from .face import BASIS, add_key, place_key

FOLLOWED = "head_key"  # the driver's variable, which says whose it is


def split(head, shapes: Sequence) -> tuple[list, list[list]]:
    """Shapes of a `heads.ForeignHead` and all its parts, as those of its own mesh and of each."""
    meshes = [part.mesh for part in head.parts]
    return native.foreign_face().shapes_of(shapes, len(head.points), meshes)


def add(
    obj: bpy.types.Object, head, shapes_of_parts: Sequence[Sequence], names: Mapping[str, str]
) -> tuple[list[str], list[str]]:
    """Gives the parts of a head their keys; names: of the head's own keys, by shape.

    Returns the names of the parts that move with the head, and why others do not.
    """
    moved, notes = [], []
    for part, shapes in zip(head.parts, shapes_of_parts, strict=True):
        shapes = [shape for shape in shapes if shape.name in names]
        if not shapes:
            continue
        target = head_parts.object_of(part)
        if target is None:
            notes.append(
                rpt_("{part} was deleted or changed meanwhile: attach again").format(part=part.name)
            )
        elif part.still:
            notes.append(
                rpt_("{part} stays where it is: {reason}").format(part=part.name, reason=part.still)
            )
        else:
            kept = _write(target, obj, shapes, names)
            moved.append(target.name)
            if kept:
                notes.append(
                    rpt_("{part} keeps keys of its own: {names}").format(
                        part=target.name, names=", ".join(kept[:4])
                    )
                )
            notes += _no_way(target, obj)
    for name in head.worn:
        if (target := bpy.data.objects.get(name)) is not None:
            notes += _no_way(target, obj)
    return moved, notes


def remove(obj: bpy.types.Object, parts: Sequence[bpy.types.Object]) -> None:
    """Takes the keys that follow a head's off objects that are no parts of it any more."""
    for part in parts:
        keys = part.data.shape_keys
        if keys is None or writable.no_shapes(part):
            continue
        own = {path for _, source, path in drivers_of(keys) if source == obj.data.shape_keys}
        for path, key in _followed(part).items():
            if path in own:
                keys.driver_remove(key.path_from_id("value"))
                part.shape_key_remove(key)
        part.data.update()


def of_worn(head) -> str:
    """What becomes of the objects that a head wears, or nothing."""
    if not head.worn:
        return ""
    return rpt_(
        "{names} left as worn, not moved by the skin (Other Objects takes them along)"
    ).format(names=", ".join(head.worn))


def _no_way(target: bpy.types.Object, obj: bpy.types.Object) -> list[str]:
    if _hangs_on(target, obj):
        return []
    return [
        rpt_("{part} does not go where {head} goes: parent it (Object > Parent)").format(
            part=target.name, head=obj.name
        )
    ]


def _write(
    target: bpy.types.Object, obj: bpy.types.Object, shapes: Sequence, names: Mapping[str, str]
) -> list[str]:
    """Returns names of keys that were the part's own before: they stay."""
    if target.data.shape_keys is None:
        target.shape_key_add(name=BASIS, from_mix=False)
    keys, kept = target.data.shape_keys, []
    rest, followed = points_of(keys.reference_key), _followed(target)
    active = target.active_shape_key_index
    for shape in shapes:
        source = obj.data.shape_keys.key_blocks[names[shape.name]]
        key = followed.get(source.path_from_id("value"))
        if key is None:
            if shape.name in keys.key_blocks:
                kept.append(shape.name)
                continue
            key = add_key(target, shape.name)
            _follow(keys, key, source)
        key.slider_min = min(key.slider_min, source.slider_min)
        key.slider_max, key.slider_min = source.slider_max, source.slider_min
        place_key(key, rest + native.placement().to_object(shape.offsets))
    target.active_shape_key_index = active
    target.data.update()
    return kept


def _followed(target: bpy.types.Object) -> dict[str, bpy.types.ShapeKey]:
    """The part's keys by the path of the head's key that they follow."""
    keys = target.data.shape_keys
    by_path = {key.path_from_id("value"): key for key in keys.key_blocks}
    pairs = ((by_path.get(driver.data_path), path) for driver, _, path in drivers_of(keys))
    return {path: key for key, path in pairs if key is not None}


def follow(part: bpy.types.Object, face: bpy.types.Object, other: bpy.types.Object) -> None:
    """Has a part's keys follow another face's instead of those that they follow."""
    before, now = face.data.shape_keys, other.data.shape_keys
    animation = part.data.shape_keys.animation_data
    for curve in animation.drivers if animation else ():
        for variable in curve.driver.variables:
            if variable.name == FOLLOWED and variable.targets[0].id == before:
                variable.targets[0].id = now


def drivers_of(keys: bpy.types.Key) -> list[tuple[bpy.types.FCurve, bpy.types.Key, str]]:
    """Drivers by which a part's keys follow its head's: each with that head's keys, and the path of
    the followed one's value."""
    animation = keys.animation_data
    return [
        (curve, variable.targets[0].id, variable.targets[0].data_path)
        for curve in (animation.drivers if animation else ())
        for variable in curve.driver.variables
        if variable.name == FOLLOWED and variable.targets[0].id is not None
    ]


def _follow(keys: bpy.types.Key, key: bpy.types.ShapeKey, source: bpy.types.ShapeKey) -> None:
    driver = keys.driver_add(key.path_from_id("value")).driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.name = FOLLOWED
    variable.targets[0].id_type = "KEY"
    variable.targets[0].id = source.id_data
    variable.targets[0].data_path = source.path_from_id("value")


def _hangs_on(target: bpy.types.Object, obj: bpy.types.Object) -> bool:
    """Whether a part is carried by the head, by what carries that, or by a rig of its own."""
    above, carrying = target.parent, {obj, *_parents(obj), *_armatures(obj)}
    while above is not None:
        if above in carrying or above.type == "ARMATURE":
            return True
        above = above.parent
    return bool(_armatures(target)) or any(not c.mute for c in target.constraints)


def _parents(obj: bpy.types.Object) -> list[bpy.types.Object]:
    parents = []
    while (obj := obj.parent) is not None:
        parents.append(obj)
    return parents


def _armatures(obj: bpy.types.Object) -> list[bpy.types.Object]:
    return [m.object for m in obj.modifiers if m.type == "ARMATURE" and m.object]
