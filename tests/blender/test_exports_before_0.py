# SPDX-License-Identifier: GPL-3.0-or-later
"""A take that begins before frame 0 is not cut by a file without a word."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_exports import face, mesh_of, read, short, world_vertices  # noqa: F401

pytestmark = pytest.mark.oldest_and_newest

KINDS = {"FBX": ".fbx", "USD": ".usdc"}


@pytest.fixture
def earlier(face):  # noqa: F811
    """Eight frames, of which the first is -4."""
    assert bpy.ops.mimetic.retime_curves(frames_later=-5.0) == {"FINISHED"}
    return face


def test_an_alembic_file_has_all_frames_under_their_numbers(scene, earlier, tmp_path):
    frames = (-4, -1, 0, 3)
    expected = [world_vertices(earlier, frame) for frame in frames]
    scene.frame_start, scene.frame_end = 3, 5
    path = tmp_path / "face.abc"
    bpy.ops.mimetic.export_character(filepath=str(path), format="ALEMBIC")
    assert "left out" not in result()["message"]
    assert (scene.frame_start, scene.frame_end) == (3, 5)
    objects, _ = read(path)
    mesh = mesh_of(objects)
    for frame, points in zip(frames, expected, strict=True):
        assert np.abs(world_vertices(mesh, frame) - points).max() < 2e-7, frame


@pytest.mark.parametrize("kind", KINDS)
def test_frames_that_an_exporter_leaves_out_are_told(scene, earlier, tmp_path, kind):
    expected = world_vertices(earlier, 0)
    scene.frame_start, scene.frame_end = 3, 5
    path = tmp_path / f"face{KINDS[kind]}"
    bpy.ops.mimetic.export_character(filepath=str(path), format=kind)
    message = result()["message"]
    assert (
        f"frames -4 to -1 are left out, as Blender's {kind} exporter begins at frame 0" in message
    )
    assert "by 4 frames or more (Retime, Later)" in message
    assert (scene.frame_start, scene.frame_end) == (3, 5)
    bpy.ops.mimetic.retime_curves(frames_later=4.0)
    bpy.ops.mimetic.export_character(filepath=str(tmp_path / f"whole{KINDS[kind]}"), format=kind)
    assert "left out" not in result()["message"]
    objects, late = read(path)
    assert np.abs(world_vertices(mesh_of(objects), late) - expected).max() < 2e-6


@pytest.mark.parametrize("kind", KINDS)
def test_a_take_that_is_all_before_frame_0_is_refused(scene, earlier, tmp_path, kind):
    bpy.ops.mimetic.retime_curves(frames_later=-5.0)
    with pytest.raises(RuntimeError, match=r"all motion is before frame 0.* by 9 frames or more"):
        bpy.ops.mimetic.export_character(filepath=str(tmp_path / "face"), format=kind)
    assert list(tmp_path.iterdir()) == []
    bpy.ops.mimetic.retime_curves(frames_later=9.0)
    bpy.ops.mimetic.export_character(filepath=str(tmp_path / "face"), format=kind)
    assert "left out" not in result()["message"]
