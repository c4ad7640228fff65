# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage whose proxies are on show, or whose pixels are not square, is measured in its own."""

import shutil
import subprocess

import pytest
from mimetic.media.ffmpeg import ffmpeg_program

FRAMES = 4
SIDE = 302  # pixels, no multiple of four: of a quarter's proxies Blender makes 300


@pytest.mark.parametrize("name", ("wide.mp4", "0001.png"))
def test_a_click_is_where_the_skin_is(folder, screen, extension, clip, work, pictures, name):
    shutil.copy(extension, work)
    is_movie = name.endswith("mp4")
    filters = f"scale={SIDE}:{SIDE},setsar={'4/3' if is_movie else '1'}"
    cut = [ffmpeg_program(), "-v", "error", "-i", clip, "-frames:v", str(FRAMES), "-vf", filters]
    subprocess.run([*cut, work / (name if is_movie else "%04d.png")], check=True)
    settings = {"extension": extension.name, "clip": name, "is_proxied": not is_movie}
    settings["name"] = "wide" if is_movie else "proxies"
    result = folder.walk(screen, "walk_pixels.py", work, pictures, settings, seconds=400)
    assert not result.failures()
    assert f"pixels-{settings['name']}" in result.pictures
