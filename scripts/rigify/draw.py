# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the person's head on a Rigify rig that a performance has turned.

    python draw.py RIG.blend PERFORMANCE.npz OUT_FOLDER

Writes OUT_FOLDER/0001.png on, a picture for each frame of the performance. Runs under
scripts/blender_env.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Vector

SIZE = 240  # pixels
SAMPLES = 4
HEAD, NECK = "DEF-spine.006", "DEF-spine.005"
EYES_ABOVE = 0.45  # of the head bone's length, over its root: the head frame's origin
EYES_BEFORE = 0.09  # metres
NECK_FROM, NECK_TO = (
    -0.14,
    -0.09,
)  # metres: below the neck alone turns the skin, above the head alone
CHARACTER_FROM_HEAD = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # a character that faces -y


def add_head(rig, vertices: np.ndarray, faces: np.ndarray):
    """The person's head (V x 3 in the head frame, metres), turned by the rig's head and neck."""
    bone = rig.data.bones[HEAD]
    root = rig.matrix_world @ bone.head_local
    eyes = np.add(root, (0, -EYES_BEFORE, EYES_ABOVE * bone.length))
    mesh = bpy.data.meshes.new("head")
    mesh.from_pydata((vertices @ CHARACTER_FROM_HEAD.T + eyes).tolist(), [], faces.tolist())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    head = bpy.data.objects.new("head", mesh)
    bpy.context.scene.collection.objects.link(head)
    share = np.clip((vertices[:, 1] - NECK_FROM) / (NECK_TO - NECK_FROM), 0, 1)
    for name, weights in ((HEAD, share), (NECK, 1 - share)):
        group = head.vertex_groups.new(name=name)
        for vertex in np.flatnonzero(weights).tolist():
            group.add([vertex], float(weights[vertex]), "REPLACE")
    head.modifiers.new("rig", "ARMATURE").object = rig
    head.modifiers.new("smooth", "SUBSURF").render_levels = 1
    skin = bpy.data.materials.new("skin")
    skin.use_nodes = True
    nodes = skin.node_tree.nodes
    nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.6, 0.42, 0.34, 1)
    mesh.materials.append(skin)
    return Vector(eyes)


def add_camera_and_light(eyes: Vector) -> None:
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location = eyes + Vector((0, -0.85, -0.02))
    camera.rotation_euler = (np.pi / 2, 0, 0)
    camera.data.lens = 85
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
    lamp.rotation_euler = (0.9, -0.3, -0.5)
    lamp.data.energy = 3
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.4, 0.42, 0.45, 1)
    scene.world = world
    for added in (camera, lamp):
        scene.collection.objects.link(added)
    scene.camera = camera


def main(rig_file: str, performance: str, folder: str) -> None:
    bpy.ops.wm.open_mainfile(filepath=rig_file)
    with np.load(performance, allow_pickle=False) as known:
        vertices, faces = known["neutral_vertices"], known["faces"]
        seconds = (known["frame"] - 1) / known["fps"].item()
    add_camera_and_light(add_head(bpy.data.objects["rig"], vertices, faces))
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.max_bounces = SAMPLES, 1
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True
    rate = scene.render.fps / scene.render.fps_base
    for i, frame in enumerate((1 + rate * seconds).tolist(), start=1):
        scene.frame_set(int(frame), subframe=frame % 1)
        scene.render.filepath = str(Path(folder) / f"{i:04}.png")
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
