# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head as Blender objects: mesh, materials, shape keys, and a studio."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
from mimetic.character.face_paint import fill_square, paint_eye, paint_lashes, paint_skin
from mimetic.template.face_template import FaceTemplate

SKIN_TEXELS, EYE_TEXELS, LASH_TEXELS = 1536, 512, (1024, 128)
# part -> (material, sRGB colour, roughness)
MATERIAL_OF_PART = {
    "skin": "Skin",
    "mouth_cavity": "Mouth",
    "eye_socket": "Mouth",
    "eye.L": "Eye",
    "eye.R": "Eye",
    "teeth_upper": "Teeth",
    "teeth_lower": "Teeth",
    "tongue": "Tongue",
    "lashes.L": "Lashes",
    "lashes.R": "Lashes",
}
LOOKS = {
    "Skin": ((0.80, 0.595, 0.50), 0.55),
    "Mouth": ((0.62, 0.33, 0.30), 0.4),
    "Eye": ((0.9, 0.88, 0.86), 0.08),
    "Teeth": ((0.85, 0.81, 0.72), 0.25),
    "Tongue": ((0.66, 0.36, 0.35), 0.4),
    "Lashes": ((0.10, 0.07, 0.06), 0.8),
}
# name -> (degrees to the subject's left, degrees from above)
VIEWS = {"front": (0, 0), "three_quarter": (40, 4), "profile": (90, 0)}


def to_blender(points: np.ndarray) -> np.ndarray:
    """Head frame (y up, z forward) -> Blender (z up, facing -y)."""
    return np.stack([points[..., 0], -points[..., 2], points[..., 1]], axis=-1)


def new_head(template: FaceTemplate, vertices: np.ndarray) -> bpy.types.Object:
    """The head with materials and two levels of subdivision, linked into the scene."""
    mesh = bpy.data.meshes.new("Head")
    mesh.from_pydata(to_blender(vertices), [], template.faces.tolist())
    mesh.shade_smooth()
    uv = fill_square(template)
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv.astype(np.float32).ravel())
    names = list(LOOKS)
    for name in names:
        mesh.materials.append(_material(name))
    _picture("Skin", paint_skin(template, uv, SKIN_TEXELS), subsurface=0.2)
    _picture("Eye", paint_eye(EYE_TEXELS))
    _picture("Lashes", paint_lashes(*LASH_TEXELS))
    slots = np.array([names.index(MATERIAL_OF_PART[part]) for part in template.part_names])
    mesh.polygons.foreach_set("material_index", slots[template.part].astype(np.int32))
    head = bpy.data.objects.new("Head", mesh)
    bpy.context.scene.collection.objects.link(head)
    modifier = head.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2
    return head


def add_shape_keys(head: bpy.types.Object, names: list[str], modes: np.ndarray) -> None:
    """A key per mode (K x V x 3, metres, head frame) on top of the mesh as it stands."""
    head.shape_key_add(name="Basis", from_mix=False)
    rest = np.empty(len(head.data.vertices) * 3, np.float32)
    head.data.vertices.foreach_get("co", rest)
    for name, mode in zip(names, modes, strict=True):
        key = head.shape_key_add(name=name, from_mix=False)
        moved = rest + to_blender(mode).astype(np.float32).ravel()
        key.points.foreach_set("co", moved)


def _material(name: str) -> bpy.types.Material:
    color, roughness = LOOKS[name]
    material = bpy.data.materials.new(f"Head {name}")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    linear = [((c + 0.055) / 1.055) ** 2.4 for c in color]
    shader.inputs["Base Color"].default_value = (*linear, 1)
    shader.inputs["Roughness"].default_value = roughness
    material.diffuse_color = (*linear, 1)
    return material


def _picture(name: str, pixels: np.ndarray, subsurface: float = 0.0) -> None:
    """Gives a material a packed texture (H x W x 3 or 4, sRGB and alpha, first row on top)."""
    height, width, channels = pixels.shape
    image = bpy.data.images.new(f"Head {name}", width, height)
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :channels] = pixels[::-1]
    image.pixels.foreach_set(rgba.ravel())
    image.pack()
    tree = bpy.data.materials[f"Head {name}"].node_tree
    shader = tree.nodes["Principled BSDF"]
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image, texture.location = image, (-340, 300)
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    if channels == 4:
        tree.links.new(texture.outputs["Alpha"], shader.inputs["Alpha"])
    shader.inputs["Subsurface Weight"].default_value = subsurface
    shader.inputs["Subsurface Radius"].default_value = (0.0037, 0.0014, 0.0007)
    shader.inputs["Subsurface Scale"].default_value = 1.0


def set_up_studio(scene: bpy.types.Scene, width: int, height: int, samples: int) -> None:
    """Key, fill and rim lights, a grey world, a portrait camera, Cycles."""
    world = bpy.data.worlds.new("Studio")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (0.16, 0.17, 0.19, 1)
    scene.world = world
    for name, place, size, power in (
        ("Key", (0.75, -1.0, 0.75), 0.7, 26),
        ("Fill", (-1.1, -0.9, 0.1), 1.2, 9),
        ("Rim", (-0.6, 1.1, 0.6), 0.8, 12),
    ):
        light = bpy.data.lights.new(name, "AREA")
        light.size, light.energy = size, power
        lamp = bpy.data.objects.new(name, light)
        lamp.location = place
        lamp.rotation_euler = _towards(np.array(place), np.zeros(3))
        scene.collection.objects.link(lamp)
    camera = bpy.data.cameras.new("Camera")
    camera.lens, camera.sensor_fit, camera.sensor_height = 85, "VERTICAL", 24
    scene.camera = bpy.data.objects.new("Camera", camera)
    scene.collection.objects.link(scene.camera)
    look_from(scene, *VIEWS["three_quarter"])
    scene.render.engine = "CYCLES"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = width, height


def look_from(scene: bpy.types.Scene, left: float, above: float) -> None:
    """Turns the camera round the head, degrees to the subject's left and from above."""
    target = np.array([0.0, -0.012, 0.005])
    side, height = math.radians(left), math.radians(above)
    away = np.array(
        [math.sin(side) * math.cos(height), -math.cos(side) * math.cos(height), math.sin(height)]
    )
    scene.camera.location = target + 1.15 * away
    scene.camera.rotation_euler = _towards(target + away, target)


def _towards(place: np.ndarray, target: np.ndarray) -> tuple[float, float, float]:
    """Euler angles of a lamp or camera at `place` that looks at `target`, upright."""
    away = (place - target) / np.linalg.norm(place - target)
    return (math.acos(away[2]), 0.0, math.atan2(away[0], -away[1]))


def render(scene: bpy.types.Scene, path: Path) -> None:
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
