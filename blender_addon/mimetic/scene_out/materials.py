# SPDX-License-Identifier: GPL-3.0-or-later
"""What the face looks like: a material for each part, the footage's own texture on the skin."""

from __future__ import annotations

import hashlib

import bpy
import numpy as np

from .. import compat

MADE = "mimetic_made"  # property of an image that we made: what was packed in it


def dress(face, appearance, is_reset: bool = False) -> list[str]:
    """Gives the face the materials of a `mimetic.appearance.Appearance`.

    A face that has materials keeps them, but for the pictures that an earlier take put on its skin.
    Returns the materials of which a picture was painted on or exchanged by hand, and is as it was;
    with `is_reset` what was painted on goes.
    """
    mesh = face.data
    if mesh.materials:
        return _repaint(mesh.materials, appearance.surfaces, is_reset)
    layer = mesh.uv_layers.get("UVMap") or mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", appearance.uv.astype(np.float32).reshape(-1))
    for surface in appearance.surfaces:
        mesh.materials.append(_material(surface))
    mesh.polygons.foreach_set("material_index", appearance.surface_of_face.astype(np.int32))
    mesh.update()
    return []


def _repaint(materials, surfaces, is_reset: bool) -> list[str]:
    others = []
    for surface in surfaces:
        material = next((m for m in materials if m and m.name.startswith(_name(surface))), None)
        if surface.texture is None or material is None or material.node_tree is None:
            continue
        nodes = [node for node in material.node_tree.nodes if node.type == "TEX_IMAGE"]
        old = [node for node in nodes if _is_as_made(node.image, is_reset)]
        if nodes and not old:
            others.append(material.name)
        for node in old:
            node.image = _image(_name(surface), surface.texture)
    return others


def _is_as_made(image: bpy.types.Image | None, even_if_painted: bool) -> bool:
    """Whether an image is ours, and nobody painted on it."""
    if image is None or MADE not in image:
        return False
    return even_if_painted or (not image.is_dirty and image[MADE] == _packed(image))


def _packed(image: bpy.types.Image) -> str:
    """Digest of what is packed in an image."""
    data = image.packed_file.data if image.packed_file else b""
    return hashlib.sha256(data).hexdigest()


def _is_cut_out(surface) -> bool:
    return surface.texture.shape[2] == 4


def _name(surface) -> str:
    return f"Face {surface.name}"


def _material(surface) -> bpy.types.Material:
    material = bpy.data.materials.new(_name(surface))
    tree = compat.use_nodes(material)
    nodes = tree.nodes
    shader = nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*surface.colour, 1.0)
    shader.inputs["Roughness"].default_value = surface.roughness
    if surface.texture is not None:
        texture = nodes.new("ShaderNodeTexImage")
        texture.location = (-320, 300)
        texture.image = _image(_name(surface), surface.texture)
        # What is cut out has one colour, the surface's own: glTF's exporter warns if both are read
        output, entry = ("Alpha", "Alpha") if _is_cut_out(surface) else ("Color", "Base Color")
        tree.links.new(texture.outputs[output], shader.inputs[entry])
    material.diffuse_color = (*surface.colour, 1.0)
    return material


def _image(name: str, pixels) -> bpy.types.Image:
    """A packed image; pixels: H x W x 3 or 4 uint8, first row on top."""
    height, width, channels = pixels.shape
    image = bpy.data.images.new(name, width, height, alpha=channels == 4)
    rgba = np.ones((height, width, 4), dtype=np.float32)
    rgba[..., :channels] = pixels[::-1] / np.float32(255)
    image.pixels.foreach_set(rgba.reshape(-1))
    image.pack()
    image[MADE] = _packed(image)
    return image
