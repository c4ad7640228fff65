# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes drawing a face dear, switched off for as long as it moves live."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy

from . import editors

NO_ANTI_ALIASING = "OFF"


class FastView:
    """Lowers anti-aliasing, overlays and outlines of the 3D views and a face's subdivision, until
    it ends.

    What someone changed meanwhile stays as they have it.
    """

    def __init__(self, face: bpy.types.Object) -> None:
        self._face = face.name
        self._smoothers = [m.name for m in face.modifiers if _subdivides(m) and m.show_viewport]
        for name in self._smoothers:
            face.modifiers[name].show_viewport = False
        with _preferences() as system:
            self._anti_aliasing, system.viewport_aa = system.viewport_aa, NO_ANTI_ALIASING
        # By address: an area may be joined with another meanwhile
        views = [area.spaces.active for area in editors.open_editors("VIEW_3D")]
        self._overlaid = {v.as_pointer() for v in views if v.overlay.show_overlays}
        self._outlined = {v.as_pointer() for v in views if v.shading.show_object_outline}
        self._show(False)

    def end(self) -> None:
        """Puts all of it back; once."""
        with _preferences() as system:
            if self._anti_aliasing and system.viewport_aa == NO_ANTI_ALIASING:
                system.viewport_aa = self._anti_aliasing
        self._anti_aliasing = ""
        self._show(True)
        self._overlaid, self._outlined = set(), set()
        if face := bpy.data.objects.get(self._face):
            for modifier in face.modifiers:
                modifier.show_viewport |= modifier.name in self._smoothers
        self._smoothers = []

    def _show(self, is_shown: bool) -> None:
        for screen in bpy.data.screens:
            for area in screen.areas:
                for space in area.spaces:
                    if space.as_pointer() in self._overlaid:
                        space.overlay.show_overlays = is_shown
                    if space.as_pointer() in self._outlined:
                        space.shading.show_object_outline = is_shown


def _subdivides(modifier: bpy.types.Modifier) -> bool:
    return modifier.type in ("SUBSURF", "MULTIRES")


@contextmanager
def _preferences() -> Iterator[bpy.types.PreferencesSystem]:
    """To be changed without Blender saving them for that when it quits."""
    preferences = bpy.context.preferences
    is_dirty = preferences.is_dirty
    try:
        yield preferences.system
    finally:
        preferences.is_dirty = is_dirty
