# SPDX-License-Identifier: GPL-3.0-or-later
"""3D views moved so that objects are seen whole."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from mathutils import Vector

from .. import editors, world

AWAY = 1.7  # times the extent: with the usual lens a sidebar has room beside the objects


def frame(camera: bpy.types.Object | None, objects: Sequence[bpy.types.Object]) -> None:
    """Moves each open 3D view to see all of the objects; one through a camera looks their way as
    that does, and leaves the camera where it is. Without a camera directions stay."""
    corners = [world.matrix(obj) @ Vector(corner) for obj in objects for corner in obj.bound_box]
    lowest = Vector(map(min, zip(*corners, strict=True)))
    highest = Vector(map(max, zip(*corners, strict=True)))
    for area in editors.open_editors("VIEW_3D"):
        view = area.spaces.active.region_3d
        if view.view_perspective == "CAMERA":
            view.view_perspective = "PERSP"
        if camera is not None:
            view.view_rotation = world.matrix(camera).to_quaternion()
        view.view_location = (lowest + highest) / 2
        view.view_distance = AWAY * max(highest - lowest)
