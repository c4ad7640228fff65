# SPDX-License-Identifier: GPL-3.0-or-later
"""What an exporter takes: a character's objects, selected alone for the while."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import native, scene_in
from . import companions

EXPORTED = {"MESH", "ARMATURE", "EMPTY"}
MOST_NAMED = 6  # of what is hidden


def character_objects(scene: bpy.types.Scene, obj: bpy.types.Object) -> list[bpy.types.Object]:
    """A face or rig with what moves it, depends on it and plays along with it (armatures, eyes,
    teeth), as far as seen. Raises InvalidInput where it is hidden itself."""
    if reason := scene_in.no_sight(obj):
        raise native.invalid_input(reason)
    return [member for member in _members(scene, obj) if member.visible_get()]


def left_out(scene: bpy.types.Scene, obj: bpy.types.Object) -> str:
    """What of a character is hidden, which files do not have; nothing where all of it is seen."""
    hidden = [member.name for member in _members(scene, obj) if not member.visible_get()]
    if not hidden:
        return ""
    names, more = ", ".join(hidden[:MOST_NAMED]), len(hidden) - MOST_NAMED
    if more > 0:
        names = rpt_("{names} and {count} more").format(names=names, count=more)
    return rpt_("without {names}, hidden in the viewport").format(names=names)


def _members(scene: bpy.types.Scene, obj: bpy.types.Object) -> list[bpy.types.Object]:
    roots = {obj, *companions.armatures(obj)}
    members = roots | {child for root in roots for child in root.children_recursive}
    # Eyeballs and teeth may hang on what carries the head, an empty for instance
    members |= {entry.part for entry in (*obj.mimetic.parts, *obj.mimetic.companions)} - {None}
    members |= set(companions.of(obj))
    for other in scene.objects:
        if any(m.type == "ARMATURE" and m.object in roots for m in other.modifiers):
            members.add(other)
    return [o for o in scene.objects if o in members and o.type in EXPORTED]


def with_shape_keys(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Meshes that have shape keys."""
    return [obj for obj in objects if obj.type == "MESH" and obj.data.shape_keys]


def one_a_mesh(objects: Iterable[bpy.types.Object]) -> list[bpy.types.Object]:
    """Of objects with shape keys, the first that has each: linked duplicates (Alt D) share them."""
    firsts: dict[bpy.types.Key, bpy.types.Object] = {}
    for obj in objects:
        firsts.setdefault(obj.data.shape_keys, obj)
    return list(firsts.values())


@contextmanager
def scene_at_hand(scene: bpy.types.Scene) -> Iterator[None]:
    """While it lasts, the window and the context have this scene: exporters write what the context
    has, or what is selected in the window's. Puts all back, also an override of the caller's."""
    context = bpy.context
    window, is_at_hand = context.window, context.scene == scene
    layer = context.view_layer if is_at_hand else scene.view_layers[0]
    if window is None or (is_at_hand and (window.scene, window.view_layer) == (scene, layer)):
        yield
        return
    before = window.scene, window.view_layer
    _show(window, scene, layer)
    try:
        with context.temp_override(scene=scene, view_layer=layer):
            yield
    finally:
        _show(window, *before)


def _show(window: bpy.types.Window, scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
    # Setting the window's scene ends an override of it: that of the caller stays below this one
    with bpy.context.temp_override(scene=scene, view_layer=layer):
        window.scene = scene
        window.view_layer = layer


@contextmanager
def selected_alone(objects: Iterable[bpy.types.Object], active: bpy.types.Object) -> Iterator[None]:
    """Selects these objects and no others, also those that cannot be, and puts all back."""
    objects = set(objects)
    view_layer = bpy.context.view_layer
    names = [obj.name for obj in view_layer.objects if obj.select_get()]
    active_before = view_layer.objects.active
    locked = _locked(objects)
    for thing in locked:
        thing.hide_select = False
    for obj in view_layer.objects:
        obj.select_set(obj in objects)
    view_layer.objects.active = active
    try:
        yield
    finally:
        for obj in view_layer.objects:
            obj.select_set(obj.name in names)
        view_layer.objects.active = active_before
        for thing in locked:
            thing.hide_select = True


def _locked(objects: set[bpy.types.Object]) -> list[bpy.types.Object | bpy.types.Collection]:
    """Objects, and collections above them, that have selecting disabled."""
    above = [
        collection
        for collection in bpy.data.collections
        if collection.hide_select and not objects.isdisjoint(collection.all_objects)
    ]
    return [*(obj for obj in objects if obj.hide_select), *above]
