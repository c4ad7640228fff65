# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws one person's shots, each under lamps of its own; runs under a Python that has `bpy`.

usage: python draw_people.py SCENE.npz TEXTURES.npz OUT_FOLDER

The scene is `evaluation.synthetic.scene.Scene`'s, with lamps (N,L,5: towards the lamp, strength,
degrees) and gloss (2 x 2: share of specular light and roughness of skin and of eyes),
ambient and teeth (how bright). Writes
frames.npy (N,H,W,4) uint8.
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "evaluation" / "synthetic"))
sys.path.insert(
    0, str(Path(__file__).resolve().parents[3] / "evaluation" / "synthetic" / "foreign")
)
import draw_head
import render_frames as drawing

SAMPLES = 3
TOOTH_WIDTH = 0.0078  # metres


def main(scene_path: str, textures_path: str, out_folder: str) -> None:
    out = Path(out_folder)
    data = dict(np.load(scene_path, allow_pickle=False))
    textures = dict(np.load(textures_path, allow_pickle=False))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    drawing.AMBIENT = float(data["ambient"])
    drawing.set_up_renderer(out)
    bpy.context.scene.cycles.samples = SAMPLES
    bpy.context.scene.render.threads_mode = "FIXED"
    bpy.context.scene.render.threads = 1
    drawing.build_camera(data)
    for name in ("teeth_upper", "teeth_lower"):
        shade = np.array(drawing.PLAIN_COLORS[name]) * data["teeth"]
        drawing.PLAIN_COLORS[name] = tuple(np.minimum(shade, 0.95))
    head = drawing.build_head(data, textures)
    draw_head.make_glossy(("skin",), *data["gloss"][0])
    draw_head.make_glossy(("eye.L", "eye.R"), *data["gloss"][1])
    _part_teeth()
    for material in bpy.data.materials:
        material.cycles.emission_sampling = "NONE"
    frames = []
    for i, vertices in enumerate(data["vertices"]):
        bpy.context.scene.cycles.seed = i
        drawing.move(head, vertices)
        head.matrix_world = Matrix(drawing.WORLD_FROM_CAMERA @ data["head_pose"][i])
        lamps = [_lamp(*lamp) for lamp in data["lamps"][i]]
        bpy.ops.render.render(write_still=True)
        frames.append(drawing.read_frame(out / "frame.png"))
        for lamp in lamps:
            bpy.data.lights.remove(lamp)
    np.save(out / "frames.npy", np.stack(frames))


def _part_teeth() -> None:
    """Dark lines between teeth, of which the mesh has one row as a whole."""
    for name in ("teeth_upper", "teeth_lower"):
        made = bpy.data.materials[name]
        nodes, links = made.node_tree.nodes, made.node_tree.links
        coordinates, wave = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeTexWave")
        ramp = nodes.new("ShaderNodeValToRGB")
        wave.inputs["Scale"].default_value = 2 * np.pi / (20 * TOOTH_WIDTH)
        links.new(coordinates.outputs["Object"], wave.inputs["Vector"])
        links.new(wave.outputs["Fac"], ramp.inputs["Fac"])
        color = np.array(drawing.PLAIN_COLORS[name])
        for element, share, place in zip(
            ramp.color_ramp.elements, (0.35, 1.0), (0.02, 0.2), strict=True
        ):
            element.color, element.position = (*(share * color), 1), place
        drawing.color_with(made, ramp.outputs["Color"])


def _lamp(x: float, y: float, z: float, strength: float, degrees: float):
    lamp = drawing.build_light((x, y, z))
    lamp.angle, lamp.energy = np.radians(degrees), strength
    return lamp


if __name__ == "__main__":
    main(*sys.argv[1:])
