# SPDX-License-Identifier: GPL-3.0-or-later
"""Lights that go along with a face.

The skin wears the footage's colours, whose light is in them: lit evenly, by as much as a white
surface needs to be white, it renders as it was filmed. They are near and weak: a metre behind the
face little of them is left.
"""

from __future__ import annotations

import math

import bpy
from mathutils import Vector

from .. import scene_in, writable

NAME = "Face Light"
AIM = Vector((0.0, -0.06, 0.0))  # the face, in its own frame, metres
AWAY = 0.8  # metres
ANGLES = ((-40.0, 12.0), (40.0, 12.0))  # degrees about the upright axis, and up
SIZE = 0.6  # metres, square: shadows without edges
POWER = 5.6  # watts each


def ensure(scene: bpy.types.Scene, face: bpy.types.Object) -> None:
    """Gives a face its lights, once: those that were deleted stay so."""
    if face.mimetic.has_lights:
        return
    face.mimetic.has_lights = True
    lamps = []
    for turn, rise in ANGLES:
        light = bpy.data.lights.new(NAME, "AREA")
        light.shape, light.size, light.energy = "SQUARE", SIZE, POWER
        lamp = bpy.data.objects.new(NAME, light)
        for collection in writable.collections_for(scene, face.users_collection):
            collection.objects.link(lamp)
        # The footage's own highlights are in its colours; two more would glare on the eyes
        light.specular_factor, lamp.visible_glossy = 0.0, False
        lamp.parent = face
        flat = AWAY * math.cos(math.radians(rise))
        across, ahead = math.sin(math.radians(turn)), math.cos(math.radians(turn))
        away = Vector((flat * across, -flat * ahead, AWAY * math.sin(math.radians(rise))))
        lamp.location = AIM + away
        lamp.rotation_mode = "QUATERNION"
        lamp.rotation_quaternion = away.to_track_quat("Z", "Y")
        lamps.append(lamp)
    # Blender draws lines from a light and to its parent: they would lie across the face
    layer = bpy.context.view_layer
    layer.update()  # what was linked just now is not among its objects yet
    for lamp in lamps:
        if scene_in.holds(layer, lamp):
            lamp.hide_set(True)
