# SPDX-License-Identifier: GPL-3.0-or-later
"""What a performance makes of a character's controls, for a table that is written without Blender:
names, and N x K values."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from .. import native, scene_in
from . import bound, face_bones, own_controls, own_keys


def write(
    scene: bpy.types.Scene,
    performance,
    obj: bpy.types.Object,
    settings: dict,
    plays_own: bool,
    out: str,
) -> str:
    """An .npz; returns what is in it. settings: as `rig_file.write`; plays_own: whether the face
    goes on the object's own controls."""
    if settings.get("as_arkit"):
        names, values, text = _units(performance, obj)
    elif obj.type == "ARMATURE":
        played = face_bones.play(scene, performance, obj, settings.get("preset"))
        names, values, text = played.names, played.values, played.summary()
    elif plays_own:
        played = own_controls.play(performance, obj, settings.get("preset"))
        names, values, text = played.names, played.values, played.summary()
    elif scene_in.is_face(obj):
        own_controls.check_no_preset(obj, settings.get("preset"))
        names, values, text = _muscles(performance, obj)
    else:
        raise native.invalid_input(
            rpt_(
                "{name} has no muscles, and no shape keys of known names: attach muscles to it"
            ).format(name=obj.name)
        )
    np.savez(out, names=np.array(names), values=values)
    return text or rpt_("{count} sliders").format(count=len(names))


def _units(performance, obj: bpy.types.Object) -> tuple[list[str], np.ndarray, str]:
    """ARKit's 52 as Live Link Face calls them: those that a character has by known names, or all
    where its muscles would make them; others are 0."""
    order = native.unit_fit().unit_order()
    has = order if scene_in.is_face(obj) else _known_units(obj)
    played = native.playing().play_units(performance, has)
    values = np.zeros((performance.num_frames, len(order)))
    values[:, [order.index(name) for name in played.names]] = played.values
    return [name[0].upper() + name[1:] for name in order], values, played.summary()


def _known_units(obj: bpy.types.Object) -> dict[str, str]:
    holders = own_keys.holders(obj) if obj.type == "MESH" else []
    has = native.control_names().units_of(name for _, keys in holders for name in keys)
    if not has:
        raise native.invalid_input(
            rpt_(
                "{name} has no shape of ARKit's 52 names that is free to move, and no muscles to "
                "make them of: attach muscles to it, or leave --names out"
            ).format(name=obj.name)
        )
    return has


def _muscles(performance, obj: bpy.types.Object) -> tuple[list[str], np.ndarray, str]:
    """The sliders that a bake would key."""
    shapes = bound.shapes_for(performance, obj)
    sliders = bound.sliders_of(obj, shapes)
    driven = own_keys.driven_keys(obj.data.shape_keys)
    playable = [
        (key.name, shape.values)
        for shape in shapes
        if (key := sliders.get(shape.name)) and key.name not in driven
    ]
    remarks = bound.no_play(obj, shapes, sliders, driven)
    if not playable:
        raise native.invalid_input("; ".join(remarks))
    names, values = zip(*playable, strict=True)
    return list(names), np.stack(values, axis=1), "; ".join(remarks)
