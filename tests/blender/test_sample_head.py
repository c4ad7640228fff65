# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample scene of the canonical head: what it saves and what it renders."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from mimetic.template.face_template import load_template

pytestmark = pytest.mark.oldest_and_newest

SCRIPT = Path(__file__).resolve().parents[2] / "sample_scenes" / "make_head.py"


def run(*arguments):
    command = [sys.executable, str(SCRIPT), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("head")
    quick = ("--view", "front", "--size", 60, 72, "--samples", 2)
    shapes = ("zygomaticus_major.L=0.5", "jawOpen=0.25")
    result = run("--out", folder / "head.blend", "--render", folder, *quick, "--shape", *shapes)
    assert result.returncode == 0, result.stderr
    return folder


def test_the_file_holds_the_head_with_keys_and_packed_pictures(made):
    bpy.ops.wm.open_mainfile(filepath=str(made / "head.blend"))
    head = bpy.data.objects["Head"]
    template = load_template()
    assert len(head.data.vertices) == len(template.vertices)
    keys = head.data.shape_keys.key_blocks
    assert len(keys) == 1 + 36 + 7 + 52
    assert keys["zygomaticus_major.L"].value == pytest.approx(0.5)
    assert keys["jawOpen"].value == pytest.approx(0.25)
    assert {m.name for m in head.data.materials} >= {"Head Skin", "Head Eye", "Head Lashes"}
    for name in ("Head Skin", "Head Eye", "Head Lashes"):
        assert bpy.data.images[name].packed_file is not None


def test_the_render_shows_a_face_on_a_grey_wall(made):
    image = bpy.data.images.load(str(made / "front.png"))
    width, height = image.size
    pixels = np.array(image.pixels[:]).reshape(height, width, 4)
    face = pixels[height // 3 : 2 * height // 3, width // 3 : 2 * width // 3, :3].mean((0, 1))
    wall = pixels[-6:, :6, :3].mean((0, 1))
    assert face[0] > 1.15 * face[1] > 1.15 * 1.02 * face[2]
    assert np.ptp(wall) < 0.1
    assert face.mean() > 0.25


def test_an_unknown_name_is_named():
    result = run("--shape", "wiggle=1")
    assert result.returncode == 2
    assert "wiggle" in result.stderr
    assert run("--shape", "jaw_open").returncode == 2
    assert "sex_male" in run("--identity", "beard=1").stderr
