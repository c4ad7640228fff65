# SPDX-License-Identifier: GPL-3.0-or-later
"""Teeth and eyes with keys of the head's names play along: baked, previewed, live, as takes."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_live import Session, clip  # noqa: F401
from test_own_controls import character, key_curves, played  # noqa: F401

pytestmark = pytest.mark.newest


def mesh_with_keys(name: str, *keys: str) -> bpy.types.Object:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, -6, 0), (1, -6, 0), (0, -6, 1)], [], [[0, 1, 2]])
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.shape_key_add(name="Basis")
    for key in keys:
        obj.shape_key_add(name=key, from_mix=False).value = 0.0
    return obj


@pytest.fixture
def cast(character, scene):  # noqa: F811
    """The head and its teeth on one armature, an eye on the head; a stranger has the same keys."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    scene.collection.objects.link(armature)
    teeth = mesh_with_keys("Teeth", "jawOpen", "tongueOut", "Gloss", "driven")
    teeth.data.shape_keys.key_blocks["driven"].driver_add("value").driver.expression = "0.5"
    for obj in (character, teeth):
        obj.modifiers.new("Armature", "ARMATURE").object = armature
    eye = mesh_with_keys("Eye", "eyeBlinkLeft", "eyeLookUpLeft")
    eye.parent = character
    stranger = mesh_with_keys("Stranger", "jawOpen")
    for key in character.data.shape_keys.key_blocks:
        key.value = 0.0
    bpy.context.view_layer.objects.active = character
    bpy.context.view_layer.update()
    return {"head": character, "teeth": teeth, "eye": eye, "stranger": stranger}


@pytest.fixture
def loaded(cast, played, scene):  # noqa: F811
    scene.render.fps = 25
    bpy.ops.mimetic.load_performance(filepath=str(played))
    return cast


def values(obj) -> dict[str, float]:
    return {key.name: key.value for key in obj.data.shape_keys.key_blocks}


def test_their_keys_get_the_heads_curves(extension, loaded):
    walk = bpy.data.actions.new("Blink")
    loaded["eye"].data.shape_keys.animation_data_create().action = walk
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    assert "Eye, Teeth moved along" in result()["message"]
    own = key_curves(extension, loaded["head"])
    teeth, eye = (key_curves(extension, loaded[name]) for name in ("teeth", "eye"))
    assert set(teeth) == {"jawOpen", "tongueOut"}
    assert set(eye) == {"eyeBlinkLeft", "eyeLookUpLeft"}
    np.testing.assert_array_equal(teeth["jawOpen"], own["jawOpen"])
    np.testing.assert_array_equal(eye["eyeBlinkLeft"], own["eyeBlinkLeft"])
    assert np.ptp(own["jawOpen"]) > 0.05
    assert loaded["stranger"].data.shape_keys.animation_data is None
    assert "tongueOut" in loaded["head"].mimetic.controls
    assert "Gloss" not in loaded["head"].mimetic.controls
    assert "Blink" in bpy.data.actions


def test_they_are_exported_with_the_head(extension, loaded, scene):
    """On an empty that carries them as it carries the head, or on an armature farther above."""
    head, teeth, eye = (loaded[name] for name in ("head", "teeth", "eye"))
    rig = head.modifiers[0].object
    carrier = bpy.data.objects.new("Carrier", None)
    scene.collection.objects.link(carrier)
    for obj in (head, teeth):
        obj.modifiers.clear()
        obj.parent = carrier
    teeth.scale = head.scale
    bpy.context.view_layer.update()
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    selection = extension("scene_out.selection")
    assert set(selection.character_objects(scene, head)) == {head, teeth, eye}
    carrier.parent = rig
    expected = {head, teeth, eye, carrier, rig}
    assert set(selection.character_objects(scene, head)) == expected


def test_takes_play_and_go_with_them(extension, loaded):
    blocks = [loaded[name].data.shape_keys for name in ("head", "teeth", "eye")]

    def playing():
        return [block.animation_data.action for block in blocks]

    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    first, name = playing(), result()["take"]
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    second, other = playing(), result()["take"]
    assert all(a != b for a, b in zip(first, second, strict=True))
    assert bpy.ops.mimetic.play_take(take=name) == {"FINISHED"}
    assert playing() == first
    names = [action.name for action in second]
    assert bpy.ops.mimetic.remove_take(take=other) == {"FINISHED"}
    assert not set(names) & set(bpy.data.actions.keys())
    bpy.data.objects.remove(loaded["teeth"])
    takes = extension("scene_out.take_list")
    assert takes.playing(loaded["head"]).name == name


def test_a_preview_shows_them_and_puts_them_back(extension, loaded, scene):
    loaded["teeth"].data.shape_keys.key_blocks["jawOpen"].value = 0.25
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    seen = []
    for frame in range(1, 41, 3):
        scene.frame_set(frame)
        assert values(loaded["teeth"])["jawOpen"] == values(loaded["head"])["jawOpen"]
        seen.append(values(loaded["teeth"])["jawOpen"])
    assert np.ptp(seen) > 0.05
    loaded["head"].mimetic.controls["jawOpen"].is_on = False
    assert values(loaded["teeth"])["jawOpen"] == pytest.approx(0.25)
    loaded["head"].mimetic.controls["jawOpen"].is_on = True
    assert bpy.ops.mimetic.preview_controls() == {"FINISHED"}
    assert values(loaded["teeth"])["jawOpen"] == pytest.approx(0.25)
    assert values(loaded["stranger"])["jawOpen"] == 0


def test_they_move_live_and_are_put_back(extension, cast, scene, clip):  # noqa: F811
    settings = scene.mimetic.live
    settings.source, settings.clip_path, settings.driven = "CLIP", str(clip), "CONTROLS"
    cast["teeth"].data.shape_keys.key_blocks["jawOpen"].value = 0.25
    driven, apart, seen = Session(extension), [], []

    def look():
        jaw = values(cast["teeth"])["jawOpen"]
        apart.append(jaw - values(cast["head"])["jawOpen"])
        seen.append(values(cast["eye"])["eyeBlinkLeft"])

    driven.run(60, look)
    driven.stop()
    assert driven.session.thread.error is None
    assert apart[-1] == 0 and np.ptp(seen) > 0.01
    driven.session.end()
    driven.session.puppet.restore()
    assert values(cast["teeth"])["jawOpen"] == pytest.approx(0.25)
