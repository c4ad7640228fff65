# SPDX-License-Identifier: GPL-3.0-or-later
"""A face without footage in a window: sliders move it, muscles and strain are drawn over it."""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Euler

sys.path.insert(0, str(Path(__file__).parent))
from walk import Steps, Walk, area_of, install, invoke, open_sidebar, override, start

PACKAGE = "bl_ext.user_default.mimetic"
SMILE = {"Lip Corners": 0.8, "frontalis_medial.L": 0.9, "frontalis_middle.L": 0.6, "jaw_open": 0.15}


def is_idle() -> bool:
    return sys.modules[f"{PACKAGE}.jobs"].running is None


def is_contact_followed() -> bool:
    known = sys.modules[f"{PACKAGE}.contact"]._states
    return any(face.values is not None for face in known.values())


def face_points() -> np.ndarray:
    """The face as the window's dependency graph has it."""
    face = bpy.context.view_layer.objects.active
    mesh = face.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    points = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", points)
    return points


def add_the_face(walk: Walk) -> Steps:
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    # Pictures are compared: smoothing goes on for a while after something has moved
    bpy.context.preferences.system.viewport_aa = "OFF"
    invoke("VIEW_3D", bpy.ops.mimetic.add_face)
    walk.check("adding a face does not block the window", not is_idle())
    yield from walk.until(is_idle, 120, "adding the face ends")
    face = bpy.context.view_layer.objects.active
    walk.check("the face is there and active", face is not None and len(face.mimetic.shapes) == 60)
    _, area = area_of("VIEW_3D")
    with bpy.context.temp_override(**override("VIEW_3D")):
        bpy.ops.view3d.view_selected()
    region = area.spaces.active.region_3d
    region.view_rotation = Euler((1.45, 0, 0.45)).to_quaternion()
    region.view_distance *= 0.8
    yield from open_sidebar(walk, "VIEW_3D", "Mimetic")
    yield 0.5


def move_the_sliders(walk: Walk) -> Steps:
    before = face_points()
    blocks = bpy.context.view_layer.objects.active.data.shape_keys.key_blocks
    for name, value in SMILE.items():
        blocks[name].value = value
    # What lips and lids do to each other is known some seconds after the face is there
    yield from walk.until(is_contact_followed, 120, "contact follows the sliders")
    yield 0.5
    moved = np.abs(face_points() - before).max()
    walk.check("sliders move the face", moved > 0.005, f"{1000 * moved:.1f} mm")


def look_at_the_overlays(walk: Walk) -> Steps:
    settings = bpy.context.scene.mimetic
    plain = face_points()
    yield from walk.picture("sliders")
    settings.show_muscles = True
    yield from walk.picture("muscles")
    settings.show_muscles, settings.show_strain = False, True
    yield from walk.picture("strain")
    settings.show_muscles = True
    yield from walk.picture("muscles-and-strain")
    settings.show_muscles = settings.show_strain = False
    yield from walk.picture("sliders-again")
    walk.check("overlays leave the face as it was", np.array_equal(face_points(), plain))
    face = bpy.context.view_layer.objects.active
    walk.check("and its data", not face.data.color_attributes and len(face.modifiers) == 1)


def reload(walk: Walk) -> Steps:
    """The overlays are a setting of the file, and are drawn after it is opened again."""
    bpy.context.scene.mimetic.show_muscles = True
    path = str(walk.folder / "face.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.open_mainfile(filepath=path)
    yield 1.0
    walk.check("the overlay is on in the opened file", bpy.context.scene.mimetic.show_muscles)
    yield from walk.picture("muscles-reloaded")


def steps(walk: Walk) -> Steps:
    yield from install(walk, PACKAGE)
    yield from add_the_face(walk)
    yield from move_the_sliders(walk)
    yield from look_at_the_overlays(walk)
    yield from reload(walk)


start(steps)
