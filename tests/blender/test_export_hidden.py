# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a character is hidden, or cannot be selected, in files for other programs."""

import bpy
import pytest
from test_exports import SUFFIXES, read

pytestmark = pytest.mark.oldest_and_newest

EVERY = (".glb", *SUFFIXES)


@pytest.fixture
def character(scene):
    """A head in a collection of its own, and hair on it."""
    collection = bpy.data.collections.new("Hero")
    scene.collection.children.link(collection)
    made = []
    for name in ("Head", "Hair"):
        bpy.ops.mesh.primitive_plane_add()
        obj = bpy.context.active_object
        obj.name = obj.data.name = name
        obj.users_collection[0].objects.unlink(obj)
        collection.objects.link(obj)
        made.append(obj)
    head, hair = made
    hair.parent = head
    head.shape_key_add(name="Basis")
    bpy.context.view_layer.update()
    return head


def names_in(path) -> set[str]:
    if path.suffix == ".glb":
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.import_scene.gltf(filepath=str(path))
    else:
        read(path)
    # By their meshes: an object may have its prim's name, or one with a number
    return {obj.data.name for obj in bpy.context.scene.objects if obj.type == "MESH"}


@pytest.mark.parametrize("suffix", EVERY)
def test_what_cannot_be_selected_is_written(extension, scene, character, tmp_path, suffix):
    hair, collection = character.children[0], character.users_collection[0]
    for thing in (character, hair, collection):
        thing.hide_select = True
    path = tmp_path / f"hero{suffix}"
    text = extension("scene_out.exports").write(scene, path, character)
    assert "hidden" not in text
    assert character.hide_select and hair.hide_select and collection.hide_select
    assert not [obj for obj in scene.objects if obj.select_get()]
    assert names_in(path) == {"Head", "Hair"}


@pytest.mark.parametrize("suffix", EVERY)
def test_what_is_hidden_is_named(extension, scene, character, tmp_path, suffix):
    character.children[0].hide_viewport = True
    path = tmp_path / f"hero{suffix}"
    text = extension("scene_out.exports").write(scene, path, character)
    assert text.endswith("without Hair, hidden in the viewport")
    assert names_in(path) == {"Head"}


@pytest.mark.parametrize("suffix", EVERY)
def test_a_hidden_character_is_refused(extension, scene, character, tmp_path, suffix):
    character.users_collection[0].hide_viewport = True
    write = extension("scene_out.exports").write
    with pytest.raises(extension("native").known_errors(), match="Head is hidden; show it"):
        write(scene, tmp_path / f"hero{suffix}", character)
    assert list(tmp_path.iterdir()) == []
