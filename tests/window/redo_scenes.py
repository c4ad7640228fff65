# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside Blender's window: the scenes in which operators are tried, one a function."""

from __future__ import annotations

import bpy
import numpy as np
from undoing import module
from walk import Walk, override

CAPTURED = 5  # the frame of the clip that corrections are of
OTHER = 9  # another one
UNITS = ("jawOpen", "mouthSmileLeft", "mouthSmileRight")
PLAIN = {"use_contact": False, "use_texture": False}


def run(walk: Walk, name: str, kind: str = "VIEW_3D", **options: object) -> None:
    with bpy.context.temp_override(**override(kind)):
        answer = getattr(bpy.ops.mimetic, name)("EXEC_DEFAULT", **options)
    if answer != {"FINISHED"}:
        raise AssertionError(f"{name}: {answer}")


def package(name: str):
    """Of the package that the extension brings."""
    return __import__(f"mimetic.{name}", fromlist=["*"])


def plain(walk: Walk) -> None:
    scene = bpy.context.scene
    scene.render.fps = 25
    scene.mimetic.performance_path = str(walk.folder / "hero.npz")


def face(walk: Walk) -> None:
    plain(walk)
    run(walk, "bake", **PLAIN)


def two_takes(walk: Walk) -> None:
    """The second one plays."""
    face(walk)
    bpy.context.scene.mimetic.performance_path = str(walk.folder / "again.npz")
    run(walk, "bake", **PLAIN)


def three_takes(walk: Walk) -> None:
    """The third one plays."""
    two_takes(walk)
    bpy.context.scene.mimetic.performance_path = str(walk.folder / "third.npz")
    run(walk, "bake", **PLAIN)


def control_object(walk: Walk) -> None:
    plain(walk)
    run(walk, "bake", to="CONTROLS", **PLAIN)


def expression(walk: Walk) -> None:
    """Our own head with two expressions to put on it."""
    plain(walk)
    run(walk, "add_face")
    kinds = package("library.expression")
    for name, muscle in (("smile", "zygomaticus_major"), ("brows", "frontalis_middle")):
        channels = [f"{muscle}.L", f"{muscle}.R"]
        values = np.outer(np.sin(np.linspace(0, np.pi, 26)) ** 2, (0.8, 0.4))
        events = np.array([[5.0, 0.5 * 25, 0.6 * 25, 0.8]])
        origin = ["clip.mp4", "1 to 26"]
        made = kinds.Expression(channels, values, 0 * values, 25.0, ["lips"], events, origin)
        module("scene_out").expressions.new_asset(name, made, 25.0)


def captured(walk: Walk) -> None:
    """A clip with its take, at a captured frame."""
    run(walk, "load_clip", filepath=str(walk.folder / "clip.mp4"))
    run(walk, "load_performance", filepath=str(walk.folder / "take.npz"))
    bpy.context.scene.frame_set(CAPTURED)


def corrected(walk: Walk) -> None:
    """In two frames."""
    captured(walk)
    show_editor("CLIP_EDITOR")
    for frame in (CAPTURED, OTHER):
        options = {"frame": frame, "value_name": "jaw_open", "value": 0.4}
        run(walk, "correct_value", "CLIP_EDITOR", **options)


def landmarks(walk: Walk) -> bpy.types.Object:
    """A head of someone's own with its landmarks in place, and an eyeball that is an object."""
    template, placement = package("template.face_template").load_template(), placement_of()
    head = _object("Bust", placement.to_object(template.vertices), template.faces)
    head.location = (0.3, -0.2, 1.5)
    bpy.context.view_layer.update()
    run(walk, "add_landmarks")
    for mark in head.children:
        vertex = template.landmark(mark.mimetic.landmark)
        mark.location = placement.to_object(template.vertices)[vertex]
    eye = np.asarray(template.part_vertices("eye.L"))
    faces = template.faces[np.isin(template.faces, eye).all(axis=1)]
    points = placement.to_object(template.vertices)[eye]
    _object("eye", points, np.searchsorted(eye, faces)).parent = head
    _choose(head)
    return head


def placement_of():
    return package("character.placement")


def character(walk: Walk) -> None:
    """A head with shape keys of its maker's, their table, and a row that was edited."""
    plain(walk)
    template, placement = package("template.face_template").load_template(), placement_of()
    points = placement.to_object(template.vertices)
    head = _object("Hero", points, template.faces)
    head.shape_key_add(name="Basis")
    for unit in UNITS:
        offsets = placement.to_object(template.unit_modes[template.unit_names.index(unit)])
        key = head.shape_key_add(name=unit, from_mix=False)
        key.points.foreach_set("co", (points + offsets).astype(np.float32).reshape(-1))
    required = package("character.foreign_mesh").REQUIRED
    for name in required:
        head.vertex_groups.new(name=name).add([template.landmark(name)], 1.0, "REPLACE")
    _choose(head)
    run(walk, "fit_controls")
    head.mimetic.controls["mouthSmileLeft"].gain = 1.5
    head.mimetic.controls["mouthSmileRight"].gain = 0.5


def _object(name: str, points, faces) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(points), [], np.asarray(faces).tolist())
    made = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(made)
    _choose(made)
    return made


def _choose(chosen: bpy.types.Object) -> None:
    layer = bpy.context.view_layer
    for obj in layer.objects:
        obj.select_set(obj == chosen)
    layer.objects.active = chosen
    layer.update()


def opened(walk: Walk, make) -> None:
    """The scene as a file of its own, so that each trial begins with it and nothing to undo."""
    path = walk.folder / f"{make.__name__}.blend"
    show_editor("VIEW_3D")
    if not path.exists():
        bpy.ops.wm.open_mainfile(filepath=str(walk.folder / "empty.blend"), load_ui=False)
        make(walk)
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False)


def show_editor(kind: str) -> None:
    """Where none of a kind is open, the largest one becomes it."""
    areas = bpy.context.window_manager.windows[0].screen.areas
    if kind not in {area.type for area in areas}:
        max(areas, key=lambda area: area.width * area.height).type = kind
