# SPDX-License-Identifier: GPL-3.0-or-later
"""Where an object stood before its head's motion was keyed: a second take starts from there too.

The action remembers the scene frame in which the target is as it was. Where the scene happens to be
when a button is pressed must not count: the head is anywhere then.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy
import numpy as np

KEPT = "mimetic_rest_frame"


def note(obj: bpy.types.Object, frame: float) -> None:
    """Remembers the frame in which the object is as it was before its action."""
    obj.animation_data.action[KEPT] = float(frame)


def forget(obj: bpy.types.Object) -> None:
    obj.animation_data.action.pop(KEPT, None)


@contextmanager
def at_rest(scene: bpy.types.Scene, obj: bpy.types.Object) -> Iterator[None]:
    """While it lasts, an object that such an action moves is as it was."""
    action = obj.animation_data.action if obj.animation_data else None
    frame = action.get(KEPT) if action else None
    if frame is None:
        yield
        return
    current_frame = scene.frame_current_final
    _show(scene, frame)
    try:
        yield
    finally:
        _show(scene, current_frame)


def _show(scene: bpy.types.Scene, frame: float) -> None:
    whole = int(np.floor(frame))
    scene.frame_set(whole, subframe=frame - whole)
