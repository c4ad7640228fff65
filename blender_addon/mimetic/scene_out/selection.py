# SPDX-License-Identifier: GPL-3.0-or-later
"""What an exporter takes: a character's objects, selected alone for the while."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy

from . import companions

EXPORTED = {"MESH", "ARMATURE", "EMPTY"}


def character_objects(scene: bpy.types.Scene, obj: bpy.types.Object) -> list[bpy.types.Object]:
    """A face or rig with what moves it, hangs on it and plays along with it (armatures, eyes,
    teeth), as far as seen."""
    roots = {obj, *companions.armatures(obj)}
    members = roots | {child for root in roots for child in root.children_recursive}
    # Eyeballs and teeth may hang on what carries the head, an empty for instance
    members |= {entry.part for entry in (*obj.mimetic.parts, *obj.mimetic.companions)} - {None}
    members |= set(companions.of(obj))
    for other in scene.objects:
        if any(m.type == "ARMATURE" and m.object in roots for m in other.modifiers):
            members.add(other)
    return [o for o in scene.objects if o in members and o.type in EXPORTED and o.visible_get()]


def with_shape_keys(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Meshes that have shape keys."""
    return [obj for obj in objects if obj.type == "MESH" and obj.data.shape_keys]


@contextmanager
def selected_alone(objects: Iterable[bpy.types.Object], active: bpy.types.Object) -> Iterator[None]:
    """Selects these objects and no others, and puts the selection back."""
    objects = set(objects)
    view_layer = bpy.context.view_layer
    names = [obj.name for obj in view_layer.objects if obj.select_get()]
    active_before = view_layer.objects.active
    for obj in view_layer.objects:
        obj.select_set(obj in objects)
    view_layer.objects.active = active
    try:
        yield
    finally:
        for obj in view_layer.objects:
            obj.select_set(obj.name in names)
        view_layer.objects.active = active_before
