# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a scene under several wide lamps on glossy skin; runs under a Python that has `bpy`.

usage: python draw_head.py SCENE.npz TEXTURES.npz OUT_FOLDER

Writes what `render_frames` writes. The scene also has lamps (L,5): towards the lamp, strength,
degrees; and gloss (2): share of specular light, roughness.
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
import render_frames as drawing

SAMPLES = 4
SKY = 0.2  # ambient light, by where the surface faces


def make_glossy(names: tuple[str, ...], gloss: float, roughness: float) -> None:
    for name in names:
        for node in bpy.data.materials[name].node_tree.nodes:
            if node.bl_idname == "ShaderNodeMixShader":
                node.inputs["Fac"].default_value = gloss
            elif node.bl_idname == "ShaderNodeBsdfGlossy":
                node.inputs["Roughness"].default_value = roughness


def main(scene_path: str, textures_path: str, out_folder: str) -> None:
    out = Path(out_folder)
    data = dict(np.load(scene_path, allow_pickle=False))
    textures = dict(np.load(textures_path, allow_pickle=False))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    drawing.AMBIENT = SKY
    drawing.set_up_renderer(out)
    cycles = bpy.context.scene.cycles
    cycles.samples = SAMPLES
    drawing.build_camera(data)
    head, body = drawing.build_head(data, textures), drawing.build_body(data)
    make_glossy(("skin", "scalp"), *data["gloss"])
    for material in bpy.data.materials:
        material.cycles.emission_sampling = "NONE"
    keys = []
    for *toward, strength, degrees in data["lamps"]:
        key = drawing.build_light(toward)
        key.angle = np.radians(degrees)
        keys.append((key, strength))
    drawing.write_topology(head, out)
    poses = data["head_pose"]
    frames, surfaces = [], [drawing.drawn_surface(head)]
    for i, vertices in enumerate(data["vertices"]):
        cycles.seed = i  # noise that stood still would be a texture
        drawing.move(head, vertices)
        head.matrix_world = Matrix(drawing.WORLD_FROM_CAMERA @ poses[i])
        stand = np.eye(4)
        stand[:3, :3] = np.diag((1, -1, -1))
        stand[:3, 3] = (poses[0, :3, 3] + poses[i, :3, 3]) / 2
        body.matrix_world = Matrix(drawing.WORLD_FROM_CAMERA @ stand)
        for key, strength in keys:
            key.energy = strength * data["light"][i, 3]
        surfaces.append(drawing.drawn_surface(head))
        bpy.ops.render.render(write_still=True)
        frames.append(drawing.read_frame(out / "frame.png"))
    np.save(out / "frames.npy", np.stack(frames))
    np.save(out / "surface.npy", np.stack(surfaces))


if __name__ == "__main__":
    main(*sys.argv[1:])
