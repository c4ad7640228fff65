# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of a character's materials are read back with the file that has them."""

import bpy
import numpy as np
import pytest
from test_exports import FPS, mesh_of, read

pytestmark = pytest.mark.oldest_and_newest

COLOURS = {"Painted": (1, 0, 0), "Packed": (0, 1, 0), "Skin": (0, 0, 1), "Other": (1, 1, 0)}


def textured(name: str, image: bpy.types.Image) -> bpy.types.Material:
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    shader = material.node_tree.nodes["Principled BSDF"]
    material.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    return material


def plain(name: str) -> bpy.types.Image:
    image = bpy.data.images.new(name, 4, 4)
    image.pixels.foreach_set(np.tile(np.float32((*COLOURS[name], 1)), 16))
    return image


def of_file(name: str, path) -> bpy.types.Image:
    image = plain(name)
    path.parent.mkdir()
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    return image


@pytest.fixture
def character(scene, tmp_path):
    """A square in four, with a picture that was painted, one that is packed, and two files of one
    name."""
    scene.render.fps = FPS
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=2, y_subdivisions=2)
    square = bpy.context.active_object
    packed = plain("Packed")
    packed.pack()
    images = plain("Painted"), packed
    images += tuple(of_file(n, tmp_path / n.lower() / "skin.png") for n in ("Skin", "Other"))
    for i, image in enumerate(images):
        square.data.materials.append(textured(image.name, image))
        square.data.polygons[i].material_index = i
    return square


def seen() -> dict[str, tuple]:
    """The colour of each material's picture in the open file."""
    found = {}
    for material in mesh_of(bpy.context.scene.objects).data.materials:
        shader = next(n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED")
        image = shader.inputs["Base Color"].links[0].from_node.image
        assert tuple(image.size) == (4, 4), (material.name, image.filepath)
        found[material.name] = tuple(round(value) for value in image.pixels[:3])
    return found


@pytest.mark.parametrize("suffix", (".fbx", ".usdc"))
def test_pictures_are_read_back(extension, scene, character, tmp_path, suffix):
    before = [(i.name, i.filepath, i.source, i.is_dirty) for i in bpy.data.images]
    (tmp_path / "out").mkdir()
    path = tmp_path / "out" / f"square{suffix}"
    export = extension("scene_out.exports").export
    export(scene, path, character)
    assert [(i.name, i.filepath, i.source, i.is_dirty) for i in bpy.data.images] == before
    moved = tmp_path / "moved"
    (tmp_path / "out").rename(moved)
    for name in ("skin", "other"):
        (tmp_path / name).rename(tmp_path / f"{name}.gone")
    read(moved / path.name)
    assert seen() == COLOURS


def test_an_earlier_files_pictures_go(extension, scene, character, tmp_path):
    path = tmp_path / "square.usdc"
    export = extension("scene_out.exports").export
    export(scene, path, character)
    folder = tmp_path / "square.usdc.textures"
    names = {"Packed.png", "Painted.png", "skin.png", "skin-2.png"}
    assert {file.name for file in folder.iterdir()} == names
    character.material_slots[0].material = None
    export(scene, path, character)
    assert {file.name for file in folder.iterdir()} == names - {"Painted.png"}
    character.data.materials.clear()
    export(scene, path, character)
    assert not folder.exists() and path.is_file()
