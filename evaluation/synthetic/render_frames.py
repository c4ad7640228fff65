# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a scene with Blender; runs in a process of its own under a Python that has `bpy`.

usage: python render_frames.py SCENE.npz TEXTURES.npz OUT_FOLDER

Writes frames.npy (N,H,W,4) uint8 straight from the renderer, and the surface that Blender drew:
surface.npy (1+N,R,3) float32 in the head frame (the first is the person at rest), quads.npy (Q,4),
quad_part.npy (Q,). Lines `frame I N` on stdout tell progress.

Blender's world is the camera's frame with y and z turned over, so the camera needs no transform.
All light is direct and from one small lamp, so that the picture has hardly any Monte-Carlo noise;
noise with the statistics of a sensor is added later.
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

SUBDIVISIONS = 1
SAMPLES = 6
LAMP_DEGREES = 2.0
KEY_STRENGTH = 1.95
WORLD_FROM_CAMERA = np.diag((1.0, -1.0, -1.0, 1.0))
PLAIN_COLORS = {
    "mouth_cavity": (0.16, 0.03, 0.03),
    "eye_socket": (0.22, 0.07, 0.06),
    "teeth_upper": (0.62, 0.57, 0.48),
    "teeth_lower": (0.55, 0.50, 0.42),
    "tongue": (0.35, 0.09, 0.09),
}
AMBIENT = 0.36
FILL_DIRECTION = (0.0, 0.45, 0.9)


def material(name: str, color=(0.5, 0.5, 0.5), image=None, gloss=0.02):
    """Lambertian skin under direct light, a constant ambient share as emission, a little gloss."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.remove(nodes["Principled BSDF"])
    diffuse, ambient = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeEmission")
    glossy, mixed = nodes.new("ShaderNodeBsdfGlossy"), nodes.new("ShaderNodeMixShader")
    summed = nodes.new("ShaderNodeAddShader")
    links.new(sky_light(nodes, links), ambient.inputs["Strength"])
    glossy.inputs["Roughness"].default_value = 0.5
    mixed.inputs["Fac"].default_value = gloss
    links.new(diffuse.outputs[0], mixed.inputs[1])
    links.new(glossy.outputs[0], mixed.inputs[2])
    links.new(mixed.outputs[0], summed.inputs[0])
    links.new(ambient.outputs[0], summed.inputs[1])
    links.new(summed.outputs[0], nodes["Material Output"].inputs["Surface"])
    if image is not None:
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = image
        color_with(made, texture.outputs["Color"])
    for shader in (diffuse, ambient):
        shader.inputs["Color"].default_value = (*color, 1)
    return made


def sky_light(nodes, links):
    """Ambient strength by where the surface faces: a soft fill without a lamp to sample."""
    normal, facing = nodes.new("ShaderNodeNewGeometry"), nodes.new("ShaderNodeVectorMath")
    scaled = nodes.new("ShaderNodeMath")
    facing.operation, scaled.operation = "DOT_PRODUCT", "MULTIPLY_ADD"
    links.new(normal.outputs["Normal"], facing.inputs[0])
    facing.inputs[1].default_value = FILL_DIRECTION
    links.new(facing.outputs["Value"], scaled.inputs[0])
    scaled.inputs[1].default_value = 0.5 * AMBIENT
    scaled.inputs[2].default_value = AMBIENT
    return scaled.outputs[0]


def color_with(made, socket) -> None:
    """Both the lit and the ambient share of a material take this colour."""
    for node in made.node_tree.nodes:
        if node.bl_idname in ("ShaderNodeBsdfDiffuse", "ShaderNodeEmission"):
            made.node_tree.links.new(socket, node.inputs["Color"])


def picture(name: str, pixels: np.ndarray):
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, float_buffer=True, is_data=True)
    rgba = np.concatenate([pixels, np.ones((height, width, 1), np.float32)], axis=2)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.update()
    return image


def build_head(data, textures):
    mesh = bpy.data.meshes.new("head")
    names = data["part_names"].tolist()
    # Lashes are cards that need an alpha map; the painted lid margins stand for them.
    drawn = ~np.isin(data["part"], [i for i, name in enumerate(names) if "lashes" in name])
    part, uv = data["part"][drawn], data["uv"][drawn].astype(np.float64)
    mesh.from_pydata(data["neutral"].tolist(), [], data["faces"][drawn].tolist())
    for index, name in enumerate(names):
        chosen = part == index
        if name in textures:
            corners = uv[chosen].reshape(-1, 2)
            uv[chosen] = (uv[chosen] - corners.min(0)) / np.ptp(corners, axis=0)
            made = material(name, image=picture(name, textures[name]))
        else:
            made = material(name, PLAIN_COLORS.get(name, (0.02, 0.015, 0.01)))
        mesh.materials.append(made)
    layer = mesh.uv_layers.new(name="uv")
    layer.data.foreach_set("uv", uv.astype(np.float32).ravel())
    mesh.polygons.foreach_set("material_index", part.astype(np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    head = bpy.data.objects.new("head", mesh)
    bpy.context.scene.collection.objects.link(head)
    subdivide = head.modifiers.new("subdivide", "SUBSURF")
    subdivide.levels = subdivide.render_levels = SUBDIVISIONS
    return head


def build_body(data):
    """Neck, collar and shoulders: rings about the spine, in the head frame's axes."""
    rings = data["body_rings"]
    turn = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    vertices = [
        (half_width * np.cos(a), height, depth + half_depth * np.sin(a))
        for height, depth, half_width, half_depth in rings
        for a in turn
    ]
    faces = [
        (32 * r + i, 32 * r + (i + 1) % 32, 32 * r + 32 + (i + 1) % 32, 32 * r + 32 + i)
        for r in range(len(rings) - 1)
        for i in range(32)
    ]
    mesh = bpy.data.meshes.new("body")
    mesh.from_pydata(vertices, [], faces)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    cloth = material("cloth", gloss=0.0)
    nodes, links = cloth.node_tree.nodes, cloth.node_tree.links
    noise, ramp = nodes.new("ShaderNodeTexNoise"), nodes.new("ShaderNodeValToRGB")
    noise.inputs["Scale"].default_value = 90
    coordinates = nodes.new("ShaderNodeTexCoord")
    links.new(coordinates.outputs["Object"], noise.inputs["Vector"])
    links.new(noise.outputs["Fac"], ramp.inputs["Fac"])
    for element, share in zip(ramp.color_ramp.elements, (0.6, 1.3), strict=True):
        element.color = (*(share * data["body_color"]), 1)
    color_with(cloth, ramp.outputs["Color"])
    mesh.materials.append(cloth)
    body = bpy.data.objects.new("body", mesh)
    bpy.context.scene.collection.objects.link(body)
    return body


def build_light(toward):
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.angle = np.radians(LAMP_DEGREES)
    sun = bpy.data.objects.new("sun", lamp)
    direction = -np.asarray(toward, float) / np.linalg.norm(toward)
    axis_z = -direction
    axis_x = np.cross((0, 1, 0), axis_z)
    axis_x /= np.linalg.norm(axis_x)
    basis = np.eye(4)
    basis[:3, :3] = np.column_stack([axis_x, np.cross(axis_z, axis_x), axis_z])
    sun.matrix_world = Matrix(basis)
    bpy.context.scene.collection.objects.link(sun)
    return lamp


def build_camera(data):
    width, height = (int(n) for n in data["image_size"])
    intrinsics = data["intrinsics"]
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.sensor_width = "HORIZONTAL", 36.0
    camera.lens = 36.0 * intrinsics[0, 0] / width
    camera.shift_x = -(intrinsics[0, 2] - (width - 1) / 2) / width
    camera.shift_y = (intrinsics[1, 2] - (height - 1) / 2) / width
    camera.clip_start, camera.clip_end = 0.01, 20
    eye = bpy.data.objects.new("camera", camera)
    scene = bpy.context.scene
    scene.collection.objects.link(eye)
    scene.camera = eye
    scene.render.resolution_x, scene.render.resolution_y = width, height


def set_up_renderer(out: Path) -> None:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.max_bounces = 0
    scene.cycles.pixel_filter_type = "BLACKMAN_HARRIS"
    scene.render.use_persistent_data = True
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGBA"
    scene.render.image_settings.compression = 0
    scene.render.filepath = str(out / "frame.png")
    scene.world = bpy.data.worlds.new("world")


def drawn_surface(head) -> np.ndarray:
    mesh = head.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", positions)
    return positions.reshape(-1, 3)


def write_topology(head, out: Path) -> None:
    mesh = head.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    quads = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", quads)
    part = np.empty(len(mesh.polygons), np.int32)
    mesh.polygons.foreach_get("material_index", part)
    np.save(out / "quads.npy", quads.reshape(-1, 4))
    np.save(out / "quad_part.npy", part)


def read_frame(path: Path) -> np.ndarray:
    image = bpy.data.images.load(str(path))
    width, height = image.size
    pixels = np.empty(4 * width * height, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    pixels = pixels.reshape(height, width, 4)[::-1]
    return np.round(255 * pixels).astype(np.uint8)


def move(head, vertices: np.ndarray) -> None:
    head.data.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
    head.data.update()


def main(scene_path: str, textures_path: str, out_folder: str) -> None:
    out = Path(out_folder)
    data = dict(np.load(scene_path, allow_pickle=False))
    textures = dict(np.load(textures_path, allow_pickle=False))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    set_up_renderer(out)
    build_camera(data)
    head, body = build_head(data, textures), build_body(data)
    key = build_light(data["light"][0, :3])
    num_frames = len(data["vertices"])
    width, height = data["image_size"]
    frames = np.empty((num_frames, height, width, 4), np.uint8)
    surfaces = [drawn_surface(head)]
    write_topology(head, out)
    first = data["head_pose"][0]
    for i in range(num_frames):
        move(head, data["vertices"][i])
        head.matrix_world = Matrix(WORLD_FROM_CAMERA @ data["head_pose"][i])
        # Shoulders follow half of where the head goes and none of its turning.
        stand = first.copy()
        stand[:3, 3] += 0.5 * (data["head_pose"][i, :3, 3] - first[:3, 3])
        stand[:3, :3] = np.diag((1, -1, -1))
        body.matrix_world = Matrix(WORLD_FROM_CAMERA @ stand)
        key.energy = KEY_STRENGTH * data["light"][i, 3]
        surfaces.append(drawn_surface(head))
        bpy.ops.render.render(write_still=True)
        frames[i] = read_frame(out / "frame.png")
        print(f"frame {i + 1} {num_frames}", flush=True)
    np.save(out / "frames.npy", frames)
    np.save(out / "surface.npy", np.stack(surfaces))


if __name__ == "__main__":
    main(*sys.argv[1:])
