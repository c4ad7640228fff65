# SPDX-License-Identifier: GPL-3.0-or-later
"""A character baked again starts from where it stood before its first take, in any frame."""

import bpy
import numpy as np
import pytest
from test_bake_bound import FRAMES, hero, loaded, world_at  # noqa: F401

pytestmark = pytest.mark.newest

SHOWN = 25  # the head is turned and away there


@pytest.fixture(params=["XYZ", "QUATERNION"])
def character(request, hero, loaded):  # noqa: F811
    hero.rotation_mode = request.param
    return hero


def places(obj) -> np.ndarray:
    return np.array([world_at(obj, frame) for frame in FRAMES])


def bake_again() -> None:
    bpy.context.scene.frame_set(SHOWN)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}


def play_strips() -> None:
    assert bpy.ops.mimetic.bake(use_strips=True) == {"FINISHED"}


def blend() -> None:
    assert bpy.ops.mimetic.bake(exaggeration=0.5) == {"FINISHED"}
    assert bpy.ops.mimetic.blend_takes(take="hero", over="hero.002") == {"FINISHED"}


def remove() -> None:
    bpy.context.scene.frame_set(SHOWN)
    assert bpy.ops.mimetic.remove_take() == {"FINISHED"}


def play_one_without_motion() -> None:
    assert bpy.ops.mimetic.bake(use_head_motion=False) == {"FINISHED"}
    bpy.context.scene.frame_set(SHOWN)
    assert bpy.ops.mimetic.play_take(take="hero.002") == {"FINISHED"}


def strips_then_without_motion() -> None:
    play_strips()
    bpy.context.scene.frame_set(SHOWN)
    assert bpy.ops.mimetic.bake(use_head_motion=False) == {"FINISHED"}


def retime() -> None:
    assert bpy.ops.mimetic.retime_curves(frames_later=-100.0) == {"FINISHED"}


def push_down() -> None:
    animation = bpy.context.active_object.animation_data
    track, action = animation.nla_tracks.new(), animation.action
    track.strips.new(action.name, 1, action)
    animation.action = None


def to_controls() -> None:
    bpy.context.scene.frame_set(SHOWN)
    assert bpy.ops.mimetic.bake(to="CONTROLS") == {"FINISHED"}


@pytest.mark.parametrize(
    "between",
    [
        play_strips,
        blend,
        remove,
        play_one_without_motion,
        strips_then_without_motion,
        retime,
        push_down,
        to_controls,
    ],
)
def test_a_second_bake_starts_where_the_first_did(character, between):
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    expected = places(character)
    between()
    bake_again()
    np.testing.assert_allclose(places(character), expected, atol=1e-5)


@pytest.mark.parametrize("take_off", [remove, play_one_without_motion, strips_then_without_motion])
def test_without_its_motion_it_stands_where_it_stood(character, take_off):
    before = np.array(character.matrix_world)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert np.abs(world_at(character, SHOWN) - before).max() > 0.01
    take_off()
    np.testing.assert_allclose(world_at(character, SHOWN), before, atol=1e-6)


def test_where_it_was_put_by_hand_without_a_take_counts(character):
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    expected = places(character)
    remove()
    character.location.x += 2.0
    bake_again()
    expected[:, 0, 3] += 2.0
    np.testing.assert_allclose(places(character), expected, atol=1e-5)


def test_what_a_take_does_not_move_is_where_it_was_put(scene, character):
    settings = scene.mimetic.head
    settings.target = character
    settings.mode, settings.use_translation = "RELATIVE", False
    assert bpy.ops.mimetic.bake_head() == {"FINISHED"}
    scene.frame_set(SHOWN)
    character.location.x += 2.0
    place = tuple(character.location)
    assert bpy.ops.mimetic.bake_head(use_translation=True) == {"FINISHED"}
    ways = [np.linalg.norm(world_at(character, frame)[:3, 3] - place) for frame in range(1, 41)]
    assert min(ways) < 1e-5


def test_a_rotation_mode_that_was_changed_since_is_the_same_place(character):
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    expected = places(character)
    remove()
    assert bpy.ops.mimetic.bake(use_strips=True) == {"FINISHED"}
    bpy.context.scene.frame_set(SHOWN)
    character.rotation_mode = "ZYX"
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    np.testing.assert_allclose(places(character), expected, atol=1e-5)
