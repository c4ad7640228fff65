# SPDX-License-Identifier: GPL-3.0-or-later
"""A take that plays as strips of the NLA is in files as one that plays as actions."""

import bpy
import numpy as np
import pytest
from test_exports import read, world_vertices

pytestmark = pytest.mark.oldest_and_newest

FRAMES = (1, 13, 20, 33)
# Metres; USD's importer cuts weights that are below 0 at 0
NEAR = {".fbx": 2e-6, ".usdc": 2e-6, ".abc": 2e-7}


@pytest.fixture
def face(bake, sheet):
    return bake(sheet, use_strips=True)


def state_of(face) -> list:
    return [
        (animation.action, animation.use_nla, [track.name for track in animation.nla_tracks])
        for animation in (face.animation_data, face.data.shape_keys.animation_data)
    ]


def test_gltf_has_the_weights_and_the_heads_motion(extension, scene, face, sheet, tmp_path):
    from mimetic.character import gltf

    before, num_actions = state_of(face), len(bpy.data.actions)
    scene.frame_set(7)
    extension("scene_out.gltf").export(scene, tmp_path / "face.glb", face)
    assert state_of(face) == before and len(bpy.data.actions) == num_actions
    assert scene.frame_current == 7
    document, _ = gltf.read_chunks((tmp_path / "face.glb").read_bytes())
    (animation,) = document["animations"]
    paths = {channel["target"]["path"] for channel in animation["channels"]}
    assert paths >= {"translation", "rotation", "weights"}
    _, weights, names = gltf.read_weights((tmp_path / "face.glb").read_bytes())
    columns = [names.index(name) for name in sheet.muscles]
    np.testing.assert_allclose(weights[:, columns], sheet.activations, atol=2e-3)


@pytest.mark.parametrize("suffix", NEAR)
def test_other_files_move_as_the_strips_do(extension, scene, face, tmp_path, suffix):
    expected = [world_vertices(face, frame) for frame in FRAMES]
    before = state_of(face)
    extension("scene_out.exports").export(scene, tmp_path / f"face{suffix}", face)
    assert state_of(face) == before
    objects, late = read(tmp_path / f"face{suffix}")
    (mesh,) = (obj for obj in objects if obj.type == "MESH")
    for frame, points in zip(FRAMES, expected, strict=True):
        assert np.abs(world_vertices(mesh, frame + late) - points).max() < NEAR[suffix], frame
