# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are switched off in the view layer, where Blender neither evaluates nor edits."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def switched_on(scene: bpy.types.Scene, obj: bpy.types.Object) -> Iterator[None]:
    """While it lasts, an object is evaluated, and may be edited, that is disabled in viewports or
    in no collection that the view layer shows."""
    if obj.visible_get():
        yield
        return
    is_disabled, is_elsewhere = obj.hide_viewport, scene.collection not in obj.users_collection
    if is_elsewhere:
        scene.collection.objects.link(obj)
    obj.hide_viewport = False
    try:
        yield
    finally:
        obj.hide_viewport = is_disabled
        if is_elsewhere:
            scene.collection.objects.unlink(obj)
