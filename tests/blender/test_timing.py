# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys fall on the second they were captured at, and footage stays behind the face."""

import dataclasses

import bpy
import numpy as np
import pytest

NTSC_FILM, NTSC = 24000 / 1001, 30000 / 1001
RATES = [
    # clip, scene fps, scene fps_base
    (25.0, 25, 1.0),
    (25.0, 24, 1.0),
    (NTSC_FILM, 24, 1.0),
    (24.0, 24, 1.001),
    (NTSC_FILM, 24, 1.001),
    (NTSC, 30, 1.0),
    (60.0, 24, 1.0),
]


def bake_at(extension, scene, performance, clip_rate, fps, fps_base, footage=None):
    scene.render.fps, scene.render.fps_base = fps, fps_base
    timed = dataclasses.replace(performance, fps=clip_rate)
    extension("scene_out").bake(scene, timed, "take", footage=footage)


@pytest.mark.parametrize(("clip_rate", "fps", "fps_base"), RATES)
def test_keys_are_at_their_seconds(extension, scene, sheet, clip_rate, fps, fps_base):
    bake_at(extension, scene, sheet, clip_rate, fps, fps_base)
    keys = scene.mimetic.face.data.shape_keys
    curve = extension("compat").curves(keys).fcurves[0]
    frames = np.array([point.co[0] for point in curve.keyframe_points])
    seconds = (frames - 1) / (fps / fps_base)
    np.testing.assert_allclose(seconds, np.arange(len(frames)) / clip_rate, atol=2e-6)
    assert (scene.render.fps, scene.render.fps_base) == (fps, pytest.approx(fps_base))


def test_the_clips_start_and_offset_count(extension, scene, sheet, footage):
    clip = extension("scene_out").clip.load(scene, str(footage))
    clip.frame_start, clip.frame_offset = 101, 3
    bake_at(extension, scene, sheet, 25.0, 25, 1.0, clip)
    curve = extension("compat").curves(scene.mimetic.face.data.shape_keys).fcurves[0]
    assert curve.keyframe_points[3].co[0] == 101  # footage frame 4 is the clip's first


def test_at_equal_rates_the_clip_itself_is_behind_the_face(extension, scene, sheet, footage):
    clip = extension("scene_out").clip.load(scene, str(footage))
    bake_at(extension, scene, sheet, 25.0, 25, 1.0, clip)
    (behind,) = scene.camera.data.background_images
    assert (behind.source, behind.clip, behind.frame_method) == ("MOVIE_CLIP", clip, "FIT")


@pytest.mark.parametrize(("fps", "fps_base"), [(24, 1.0), (30, 1.001), (50, 1.0)])
def test_at_other_rates_the_picture_behind_keeps_the_seconds(
    extension, scene, sheet, footage, fps, fps_base
):
    clip = extension("scene_out").clip.load(scene, str(footage))
    bake_at(extension, scene, sheet, 25.0, fps, fps_base, clip)
    rate = fps / fps_base
    for frame in range(1, int(1.4 * rate)):
        scene.frame_set(frame)
        camera = scene.camera.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        user = camera.background_images[0].image_user
        shown = frame - user.frame_start + 1 + user.frame_offset
        assert shown == 1 + int(np.floor((frame - 1) / rate * 25 + 1e-6))


def test_baking_at_the_clips_rate_again_shows_the_clip_again(extension, scene, sheet, footage):
    clip = extension("scene_out").clip.load(scene, str(footage))
    bake_at(extension, scene, sheet, 25.0, 24, 1.0, clip)
    bake_at(extension, scene, sheet, 25.0, 25, 1.0, clip)
    (behind,) = scene.camera.data.background_images
    assert behind.source == "MOVIE_CLIP"
