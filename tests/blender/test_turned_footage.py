# SPDX-License-Identifier: GPL-3.0-or-later
"""A phone's film is stored as its sensor lies, and says how it is to be turned."""

import subprocess

import bpy
import numpy as np
import pytest
from imageio_ffmpeg import get_ffmpeg_exe
from last_result import result

TURNS_CLIPS = bpy.app.version >= (4, 5, 0)


@pytest.fixture(params=[90, 180, 270])
def turned(request, footage, tmp_path):
    """The stripes of 400 x 300, turned by so many degrees anticlockwise."""
    path = tmp_path / "phone.mp4"
    command = [get_ffmpeg_exe(), "-v", "error", "-display_rotation", str(request.param)]
    subprocess.run([*command, "-i", str(footage), "-c", "copy", str(path)], check=True)
    return path, request.param


def shown_by_blender(path) -> np.ndarray:
    """The first frame as Blender decodes it, rows from the top, 0 to 1."""
    image = bpy.data.images.load(str(path))
    image.source = "MOVIE"
    width, height = image.size
    return np.array(image.pixels).reshape(height, width, 4)[::-1, :, :3]


def test_blender_and_we_see_the_same_picture_or_it_is_told(extension, scene, turned):
    path, angle = turned
    assert bpy.ops.mimetic.load_clip(filepath=str(path)) == {"FINISHED"}
    footage = extension("native").footage().Footage(path)
    assert footage.rotation == angle
    is_told = f"says that it is turned by {angle} degrees" in result()["message"]
    assert is_told != TURNS_CLIPS
    ours, theirs = footage.read(1) / 255, shown_by_blender(path)
    if TURNS_CLIPS:
        assert tuple(scene.mimetic.clip.size) == footage.size
        assert np.abs(ours - theirs).mean() < 0.03
    else:
        assert ours.shape != theirs.shape or np.abs(ours - theirs).mean() > 0.1
