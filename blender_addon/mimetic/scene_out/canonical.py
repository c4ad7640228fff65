# SPDX-License-Identifier: GPL-3.0-or-later
"""A face without footage: the canonical head with its muscles, for animating by hand."""

from __future__ import annotations

import bpy

from . import face, materials


def add(collection: bpy.types.Collection, head, location, subdivision: int) -> bpy.types.Object:
    """Puts a `mimetic.canonical_head.Head` into a collection, at rest; location: in the world."""
    added = face.new(head.vertices, head.faces)
    collection.objects.link(added)
    added.mimetic.use_contact = True
    face.set_shapes(added, head.vertices, head.shapes, head.groups)
    face.subdivide(added, subdivision)
    materials.dress(added, head.appearance)
    added.location = location
    return added


def select_only(view_layer: bpy.types.ViewLayer, chosen: bpy.types.Object) -> None:
    """Selects an object alone and makes it active, as Blender does with what was just added."""
    view_layer.update()  # what was linked just now is not among its objects yet
    for shown in view_layer.objects:
        shown.select_set(shown == chosen)
    view_layer.objects.active = chosen
