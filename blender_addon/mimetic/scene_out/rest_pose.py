# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest: of a rig for as long as it is measured, whatever the frame shows, and put back after; and
of what a curve has moved."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

from . import own_keys

REST = {
    "location": (0.0, 0.0, 0.0),
    "rotation_quaternion": (1.0, 0.0, 0.0, 0.0),
    "rotation_euler": (0.0, 0.0, 0.0),
    "rotation_axis_angle": (0.0, 0.0, 1.0, 0.0),
    "scale": (1.0, 1.0, 1.0),
}
MOVED = re.compile(r'(?:pose\.bones|key_blocks)\["(?:[^"\\]|\\.)*"\]')


@contextmanager
def held(armature: bpy.types.Object | None, face: bpy.types.Object) -> Iterator[None]:
    """All bones, and the mesh's sliders but for those that drivers set, at rest; the mesh without
    modifiers that make other vertices."""
    posed = list(armature.pose.bones) if armature is not None else []
    poses = [{name: tuple(getattr(bone, name)) for name in REST} for bone in posed]
    driven = own_keys.driven_keys(face.data.shape_keys)
    sliders = [key for key in face.data.shape_keys.key_blocks if key.name not in driven]
    values = [key.value for key in sliders]
    others = [m for m in face.modifiers if m.type != "ARMATURE" and m.show_viewport]
    try:
        for bone in posed:
            _put(bone, REST)
        for key in sliders:
            key.value = 0.0
        for modifier in others:
            modifier.show_viewport = False
        yield
    finally:
        for bone, pose in zip(posed, poses, strict=True):
            _put(bone, pose)
        for key, value in zip(sliders, values, strict=True):
            key.value = value
        for modifier in others:
            modifier.show_viewport = True
        bpy.context.view_layer.update()


def _put(bone: bpy.types.PoseBone, pose: dict[str, tuple]) -> None:
    for name, values in pose.items():
        setattr(bone, name, values)


def evaluated(mesh: bpy.types.Object) -> np.ndarray:
    """V x 3: the points of a mesh as modifiers leave it now, in its own frame."""
    bpy.context.view_layer.update()
    vertices = mesh.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
    points = np.empty(3 * len(vertices), dtype=np.float32)
    vertices.foreach_get("co", points)
    return points.reshape(-1, 3).astype(np.float64)


def moved_by(path: str) -> str:
    """Path of the bone or shape key that a curve with a path moves; nothing for an object."""
    found = MOVED.match(path)
    return found.group() if found else ""


def put_to_rest(id_block: bpy.types.ID, path: str, index: int) -> None:
    """What a curve has moved; an object stays where it is, and what is gone is passed over."""
    owner = moved_by(path)
    try:
        thing = id_block.path_resolve(owner) if owner else None
    except ValueError:  # a bone or key that is gone
        return
    name = path[len(owner) :]
    if thing is None:
        return
    if name.startswith("["):
        _put_own_property(thing, bpy.utils.unescape_identifier(name[2:-2]))
        return
    of = thing.bl_rna.properties.get(name[1:])
    if of is None:  # of a bone's constraint, for instance: no rest of a bone or key
        return
    if isinstance(thing, bpy.types.ShapeKey):
        thing.value = 0.0  # Blender 5.0 gives 1 as the property's default
    elif of.is_array:
        getattr(thing, of.identifier)[index] = of.default_array[index]
    else:
        setattr(thing, of.identifier, of.default)


def _put_own_property(bone: bpy.types.PoseBone, name: str) -> None:
    if isinstance(value := bone.get(name), int | float):
        bone[name] = type(value)(bone.id_properties_ui(name).as_dict().get("default", 0))
