# SPDX-License-Identifier: GPL-3.0-or-later
"""Files have the scene that is exported, whatever other scenes there are and the window shows."""

import json
import struct
from contextlib import nullcontext

import bpy
import pytest
from test_export_hidden import EVERY, names_in

pytestmark = pytest.mark.oldest_and_newest


def add_head(scene, name: str, fps: int):
    """A head of four vertices that opens its mouth, in a scene of its own rate."""
    scene.render.fps = fps
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [], [(0, 1, 2, 3)])
    head = bpy.data.objects.new(name, mesh)
    scene.collection.objects.link(head)
    head.shape_key_add(name="Basis")
    key = head.shape_key_add(name="jaw_open")
    key.points[0].co.z += 0.1
    for frame, value in ((1, 0.0), (8, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    return head


@pytest.fixture
def scenes():
    """The window's, and another one with view layers of which the second is not the first shown."""
    shown, other = bpy.context.scene, bpy.data.scenes.new("Other")
    other.view_layers.new("Second")
    return shown, other


@pytest.fixture
def heads(scenes):
    heads = [add_head(*row) for row in zip(scenes, ("Shown", "Else"), (25, 50), strict=True)]
    for scene, head in zip(scenes, heads, strict=True):
        for layer in scene.view_layers:
            head.select_set(True, view_layer=layer)
    return heads


def override(scene, of: str):
    if of == "nothing":
        return nullcontext()
    options = {"view_layer": scene.view_layers[-1]} if of == "its layer" else {}
    return bpy.context.temp_override(scene=scene, **options)


@pytest.mark.parametrize("of", ["nothing", "the scene", "its layer"])
@pytest.mark.parametrize("which", [0, 1], ids=["of the window", "another"])
@pytest.mark.parametrize("suffix", EVERY)
def test_a_file_has_the_scene_that_is_given(extension, scenes, heads, tmp_path, suffix, which, of):
    scene, head = scenes[which], heads[which]
    path, name = tmp_path / f"hero{suffix}", head.data.name
    before = bpy.context.window.view_layer
    with override(scene, of):
        layer = bpy.context.view_layer
        extension("scene_out.exports").write(scene, path, head)
        if of != "nothing":
            assert bpy.context.scene == scene
        assert bpy.context.view_layer == layer
    window = bpy.context.window
    assert (window.scene, window.view_layer) == (scenes[0], before)
    assert bpy.context.scene == scenes[0]
    for one, other in zip(scenes, heads, strict=True):
        assert all(other.select_get(view_layer=layer) for layer in one.view_layers)
    assert names_in(path) == {name}


def document_of(path) -> dict:
    data = path.read_bytes()
    (length,) = struct.unpack("<I", data[12:16])
    return json.loads(data[20 : 20 + length])


@pytest.mark.parametrize("kind", ["LINK_COPY", "EMPTY"])
def test_a_gltf_file_has_one_scene_and_nothing_selected_elsewhere(
    extension, scenes, heads, tmp_path, kind
):
    head = heads[0]
    bpy.ops.scene.new(type=kind)
    scene = bpy.context.scene
    assert scene not in scenes
    if kind == "EMPTY":
        scene.collection.objects.link(head)
    scene.render.fps = 50
    path = tmp_path / "hero.glb"
    extension("scene_out.gltf").export(scene, path, head)
    document = document_of(path)
    assert [one["name"] for one in document["scenes"]] == [scene.name]
    assert [node["name"] for node in document["nodes"]] == ["Shown"]
    (animation,) = document["animations"]
    (sampler,) = animation["samplers"]
    assert document["accessors"][sampler["input"]]["max"] == pytest.approx([7 / 50])
