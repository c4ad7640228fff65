# SPDX-License-Identifier: GPL-3.0-or-later
"""The clip with the head held still."""

import bpy
import numpy as np
import pytest

NAMES = ("Head Centre", "Head Above")


@pytest.fixture
def clip(scene, footage, performance_file):
    bpy.ops.mimetic.load_clip(filepath=str(footage))
    bpy.ops.mimetic.load_performance(filepath=str(performance_file))
    scene.mimetic.head.smoothing = 0.0
    return scene.mimetic.clip


def pixels(clip, name: str, frame: int) -> np.ndarray:
    co = clip.tracking.objects[0].tracks[name].markers.find_frame(frame).co
    return np.array([co[0] * 400 - 0.5, (1 - co[1]) * 300 - 0.5])


def test_the_clip_is_stabilised_on_the_head(clip, performance):
    assert bpy.ops.mimetic.hold_head_still() == {"FINISHED"}
    stabilisation = clip.tracking.stabilization
    assert stabilisation.use_2d_stabilization
    assert [track.name for track in stabilisation.tracks] == [NAMES[0]]
    assert [track.name for track in stabilisation.rotation_tracks] == [NAMES[1]]
    for frame in (1, 13, 40):
        pose = performance.head_pose[frame - 1]
        nose = pose[:3, :3] @ [0, -0.01, 0.085] + pose[:3, 3]
        (expected,) = performance.project(nose[None])
        np.testing.assert_allclose(pixels(clip, NAMES[0], frame), expected, atol=1e-3)
        # What is held has the head's roll, and a length that follows its depth alone
        arm = pixels(clip, NAMES[1], frame) - pixels(clip, NAMES[0], frame)
        up = performance.project((nose + pose[:3, 1] * 0.02)[None])[0] - expected
        along = arm @ up / np.linalg.norm(arm) / np.linalg.norm(up)
        assert along == pytest.approx(1, abs=1e-4)
        depths = (
            performance.head_pose[:, 2, :3] @ [0, -0.01, 0.085] + performance.head_pose[:, 2, 3]
        )
        reach = 75 * np.median(depths) / depths[frame - 1]
        assert np.linalg.norm(arm) == pytest.approx(reach, rel=1e-4)


def test_again_replaces_and_release_leaves_no_trace(clip):
    mine = clip.tracking.objects[0].tracks.new(name="mine", frame=1)
    mine.select = False
    screens = [[area.ui_type for area in screen.areas] for screen in bpy.data.screens]
    assert not bpy.ops.mimetic.release_head.poll()
    for _ in range(2):
        assert bpy.ops.mimetic.hold_head_still() == {"FINISHED"}
        assert set(clip.tracking.objects[0].tracks.keys()) == {"mine", *NAMES}
    assert bpy.ops.mimetic.release_head() == {"FINISHED"}
    assert clip.tracking.objects[0].tracks.keys() == ["mine"]
    assert len(clip.tracking.stabilization.tracks) == 0
    assert not clip.tracking.stabilization.use_2d_stabilization
    assert screens == [[area.ui_type for area in screen.areas] for screen in bpy.data.screens]


def test_the_users_own_stabilisation_is_left_alone(clip, extension):
    tracks = clip.tracking.objects[0].tracks
    tracks.new(name="mine", frame=1)
    stabilised = extension("scene_out").stabilised
    stabilised._call(clip, bpy.ops.clip.stabilize_2d_add, ("mine",))
    assert not bpy.ops.mimetic.hold_head_still.poll()
    assert "mine" in extension("scene_in").no_stabilising(bpy.context)


def test_tracks_of_the_users_that_are_called_so_stay(clip):
    mine = clip.tracking.objects[0].tracks.new(name=NAMES[0], frame=1)
    mine.select = False
    for _ in range(2):
        assert bpy.ops.mimetic.hold_head_still() == {"FINISHED"}
        assert len(clip.tracking.objects[0].tracks) == 3
        assert len(clip.tracking.objects[0].tracks[NAMES[0]].markers) <= 2
    assert not bpy.ops.mimetic.hold_head_still.poll() or bpy.ops.mimetic.release_head.poll()
    assert bpy.ops.mimetic.release_head() == {"FINISHED"}
    assert clip.tracking.objects[0].tracks.keys() == [NAMES[0]]
