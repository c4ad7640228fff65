# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample scene of a face that is animated by hand."""

import subprocess
import sys
from pathlib import Path

import bpy
import pytest

pytestmark = pytest.mark.newest

SCRIPT = Path(__file__).resolve().parents[2] / "sample_scenes" / "make_sliders.py"


def test_the_scene_has_sliders_keys_and_overlays(tmp_path, extension):
    path = tmp_path / "sliders.blend"
    ran = subprocess.run(
        [sys.executable, str(SCRIPT), "--out", str(path)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    bpy.ops.wm.open_mainfile(filepath=str(path))
    scene = bpy.context.scene
    assert scene.mimetic.show_muscles
    assert scene.mimetic.show_strain
    face = bpy.data.objects["Face"]
    assert len(face.mimetic.shapes) == 60
    assert len(face.mimetic.groups) == 21
    blocks = face.data.shape_keys.key_blocks
    parted = extension("scene_out.contact").key_of(face)
    rest = extension("scene_out.contact").points_of(face.data.shape_keys.reference_key)
    for frame, least in ((14, 0.0), (66, 0.0003), (86, 0.001)):  # lips apart, a blink, lips pressed
        scene.frame_set(frame)
        moved = extension("scene_out.contact").points_of(parted) - rest
        assert (abs(moved).max() > least) == (least > 0)
    scene.frame_set(56)
    assert blocks["Lip Corners"].value == pytest.approx(0.4)
    assert blocks["lid_upper.L"].value == pytest.approx(1.0)
    assert blocks["zygomaticus_major.R"].value == pytest.approx(0.0)
    pose = extension("overlay.live").look(face).pose
    assert pose.activations.max() == pytest.approx(0.4)
