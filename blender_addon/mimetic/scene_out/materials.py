# SPDX-License-Identifier: GPL-3.0-or-later
"""What the face looks like: a material for each part, the footage's own texture on the skin."""

from __future__ import annotations

import bpy
import numpy as np

from .. import compat


def dress(face, appearance) -> None:
    """Gives the face the materials of a `mimetic.appearance.Appearance`.

    A face that has materials keeps them, but for the pictures on its skin.
    """
    mesh = face.data
    if mesh.materials:
        _repaint(mesh.materials, appearance.surfaces)
        return
    layer = mesh.uv_layers.get("UVMap") or mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", appearance.uv.astype(np.float32).reshape(-1))
    for surface in appearance.surfaces:
        mesh.materials.append(_material(surface))
    mesh.polygons.foreach_set("material_index", appearance.surface_of_face.astype(np.int32))
    mesh.update()


def _repaint(materials, surfaces) -> None:
    for surface in surfaces:
        material = next((m for m in materials if m and m.name.startswith(_name(surface))), None)
        if surface.texture is None or material is None or material.node_tree is None:
            continue
        for node in material.node_tree.nodes:
            if node.type == "TEX_IMAGE":
                node.image = _image(_name(surface), surface.texture)


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
    return image
