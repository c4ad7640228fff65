# SPDX-License-Identifier: GPL-3.0-or-later
"""Action units of FACS beside the muscles: sliders of both sides, and an action of each."""

import dataclasses

import bpy
import numpy as np
import pytest
from mimetic.muscles.action_units import unit_meanings

UNITS = list(unit_meanings())
SLIDERS = [f"{u}.{side}" for u in UNITS if u != "AU26" for side in "LR"] + ["AU26"]


def offsets(key, basis):
    """V x 3, of a shape key from the face at rest."""
    rows = [np.empty(3 * len(k.points), np.float32) for k in (key, basis)]
    for row, k in zip(rows, (key, basis), strict=True):
        k.points.foreach_get("co", row)
    return (rows[0] - rows[1]).reshape(-1, 3)


def test_a_bake_has_units_beside_the_muscles_and_their_curves(extension, scene, performance):
    bake = extension("scene_out").bake
    bake(scene, performance, "take", with_units=True)
    keys = scene.mimetic.face.data.shape_keys
    assert set(SLIDERS) <= {key.name for key in keys.key_blocks}
    curves = extension("compat").curves(keys).fcurves
    assert len(curves) == 36 + len(performance.articulators)  # a take moves no unit
    assert sorted(a.name for a in bpy.data.actions if a.asset_data) == sorted(UNITS)
    bake(scene, performance, "take")
    assert not {key.name for key in keys.key_blocks} & set(SLIDERS)


def test_sliders_move_their_side_by_intensity_and_add_up(extension, scene, performance):
    extension("scene_out").bake(scene, performance, "take", with_units=True, subdivision=0)
    face = scene.mimetic.face
    keys = face.data.shape_keys
    left, right = (offsets(keys.key_blocks[f"AU12.{s}"], keys.reference_key) for s in "LR")
    x = np.array([p.co.x for p in keys.reference_key.points])
    assert np.abs(left[x < -0.013]).max() < 1e-6 < 0.005 < np.abs(left[x > 0.013]).max()
    assert np.abs(right[x > 0.013]).max() < 1e-6
    from mimetic.muscles.action_units import action_unit
    from mimetic.template.face_template import load_template

    whole = action_unit("AU12", performance.neutral_vertices, load_template()).mode
    moved = np.column_stack([whole[:, 0], -whole[:, 2], whole[:, 1]])
    np.testing.assert_allclose(left + right, moved, atol=2e-6)
    assert (keys.key_blocks["AU12.L"].slider_min, keys.key_blocks["AU12.L"].slider_max) == (0, 2)


@pytest.mark.oldest_and_newest
def test_an_action_of_a_unit_is_a_linear_ramp_on_any_face(extension, scene):
    scene.render.fps = 30
    assert bpy.ops.mimetic.add_face(use_units=True, subdivision=0) == {"FINISHED"}
    scene.frame_set(11)
    bpy.ops.mimetic.sequence_expression(action="AU2")
    seen = []
    blocks = bpy.context.active_object.data.shape_keys.key_blocks
    for frame in range(11, 48):
        scene.frame_set(frame)
        seen.append([blocks["AU2.L"].value, blocks["AU2.R"].value])
    ramp = np.interp(np.arange(37), [0, 12, 24, 36], [0.0, 1, 1, 0])
    np.testing.assert_allclose(np.array(seen).T, [ramp, ramp], atol=1e-5)
    bpy.ops.mimetic.apply_expression(action="AU2", share=0.5)  # any by intensity


def test_units_go_into_gltf(extension, scene, performance, tmp_path):
    from mimetic.character.gltf import read_weights

    extension("scene_out").bake(scene, performance, "take", with_units=True, with_groups=False)
    extension("scene_out").gltf.export(scene, tmp_path / "face.glb")
    _, weights, names = read_weights((tmp_path / "face.glb").read_bytes())
    assert set(SLIDERS) <= set(names)
    assert not weights[:, [names.index(name) for name in SLIDERS]].any()


def test_units_are_refused_on_another_mesh_before_anything_changes(extension, scene, performance):
    other = dataclasses.replace(
        performance,
        neutral_vertices=performance.neutral_vertices[:-1],
        muscle_modes=performance.muscle_modes[:, :-1],
        articulator_modes=performance.articulator_modes[:, :-1],
        faces=performance.faces[(performance.faces < 5000).all(axis=1)],
    )
    with pytest.raises(ValueError, match="action units are known on that one alone"):
        extension("scene_out").bake(scene, other, "take", with_units=True)
    assert scene.mimetic.face is None
