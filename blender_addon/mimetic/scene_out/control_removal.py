# SPDX-License-Identifier: GPL-3.0-or-later
"""From a control object back to shape keys: what it does as curves of the face's own."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from .. import compat, world, writable
from . import actions, control_drivers, control_object, strip_curves
from .switched_on import switched_on


@dataclass
class Sampled:
    """What a face does, frame by frame."""

    frames: np.ndarray  # N scene frames
    values: dict[str, np.ndarray]  # N of each key
    locations: np.ndarray | None  # N x 3, of the object in the world, where its control moves it
    quaternions: np.ndarray | None  # N x 4


def remove(scene: bpy.types.Scene, face: bpy.types.Object, use_curves: bool) -> int:
    """Takes the control object away; returns the number of curves that keep what it did."""
    writable.check(writable.no_shapes(face))
    control, other = control_object.of(face), control_object.other_face(face)
    if other is not None and other.data == face.data:  # drivers are the mesh's
        writable.check(writable.no_own_mesh(face))
    with switched_on(scene, face):
        sampled = sample(scene, face) if use_curves and control is not None else None
        take = _uppermost(control).name if sampled else ""
        if control is not None and control.animation_data is not None and other is None:
            _put_away(control)
        control_object.remove(face)
    if sampled is None:
        return 0
    return key(face, take, sampled)


def _uppermost(control: bpy.types.Object) -> bpy.types.Action:
    """Of the actions that play it, the one over the others."""
    return control.animation_data.action or strip_curves.playing(control)[-1].action


def _put_away(control: bpy.types.Object) -> None:
    """Its actions stay in the file, those of strips too."""
    actions.put_away(control)
    for track in control.animation_data.nla_tracks:
        for strip in track.strips:
            if strip.action is not None:
                strip.action.use_fake_user = True


def sample(scene: bpy.types.Scene, face: bpy.types.Object) -> Sampled | None:
    """The face in every frame in which an action or strips play its control object; None where
    none does."""
    frames = _frames(control_object.of(face))
    if frames is None:
        return None
    names = sorted(control_drivers.keys_driven(face))
    rows, places = [], []
    current_frame = scene.frame_current_final
    for frame in frames:
        scene.frame_set(int(frame))
        keys = face.data.shape_keys.evaluated_get(bpy.context.evaluated_depsgraph_get())
        rows.append([keys.key_blocks[name].value for name in names])
        places.append(world.matrix(face).copy())
    scene.frame_set(int(np.floor(current_frame)), subframe=float(current_frame % 1))
    values = dict(zip(names, np.array(rows).T, strict=True))
    if not control_object.carries(face):
        return Sampled(frames, values, None, None)
    quaternions = [place.to_quaternion() for place in places]
    for one, before in zip(quaternions[1:], quaternions, strict=False):
        one.make_compatible(before)
    return Sampled(
        frames,
        values,
        np.array([place.translation for place in places]),
        np.array(quaternions),
    )


def _frames(control: bpy.types.Object) -> np.ndarray | None:
    """N scene frames, from the first key or strip to the last."""
    holder = compat.curves(control)
    spans = [curve.range() for curve in holder.fcurves] if holder is not None else []
    spans += [(strip.frame_start, strip.frame_end) for strip in strip_curves.playing(control)]
    if not spans:
        return None
    first, last = min(low for low, _ in spans), max(high for _, high in spans)
    return np.arange(int(np.floor(first)), int(np.ceil(last)) + 1)


def key(face: bpy.types.Object, take: str, sampled: Sampled) -> int:
    """Curves on a face that no control object drives."""
    keys = face.data.shape_keys
    groups = {entry.name: entry.group for entry in (*face.mimetic.shapes, *face.mimetic.groups)}
    holder = actions.continued_take(keys, f"{take} muscles")
    for name, values in sampled.values.items():
        path = keys.key_blocks[name].path_from_id("value")
        actions.clear(holder, path)
        curve = compat.new_curve(holder, path, 0, groups.get(name, "Face"))
        actions.fill(curve, sampled.frames, values, actions.LINEAR)
    num_curves = len(sampled.values)
    if sampled.locations is not None:
        face.rotation_mode = "QUATERNION"
        holder = actions.new_take(face, f"{take} head")
        for path, rows in (
            ("location", sampled.locations),
            ("rotation_quaternion", sampled.quaternions),
        ):
            num_curves += actions.key_columns(holder, path, "Head", sampled.frames, rows)
    return num_curves
