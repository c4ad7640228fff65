# SPDX-License-Identifier: GPL-3.0-or-later
"""A face without footage: the canonical head with its muscles, for animating by hand."""

from __future__ import annotations

import bpy

from .. import scene_in
from . import face, materials


def add(
    collection: bpy.types.Collection, head, location, subdivision: int, units=()
) -> bpy.types.Object:
    """Puts a `mimetic.canonical_head.Head` into a collection, at rest.

    location: in the world; units: further shapes, of action units.
    """
    obj = face.new(head.vertices, head.faces)
    collection.objects.link(obj)
    obj.mimetic.use_contact = True
    face.set_shapes(obj, head.vertices, [*head.shapes, *units], head.groups)
    face.subdivide(obj, subdivision)
    materials.dress(obj, head.appearance)
    obj.location = location
    return obj


def select_only(view_layer: bpy.types.ViewLayer, target: bpy.types.Object) -> bool:
    """Selects an object alone and makes it active, as Blender does with what was just added.

    Not one in an excluded collection, where nothing is selected; returns whether it could.
    """
    view_layer.update()  # what was linked just now is not among its objects yet
    if not scene_in.holds(view_layer, target):
        return False
    for obj in view_layer.objects:
        obj.select_set(obj == target)
    view_layer.objects.active = target
    return True
