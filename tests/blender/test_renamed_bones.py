# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of a face that are renamed after a bake on them: a take that waits says what it lacks, and
one that plays takes nothing of it along into the next."""

import bpy
import numpy as np
import pytest
from last_result import result
from test_face_bones import rig  # noqa: F401
from test_takes import rows

pytestmark = pytest.mark.oldest_and_newest

FRAMES = range(1, 13)


@pytest.fixture
def bake_rig(rig, scene, tmp_path):  # noqa: F811
    """Bakes an acting, in which jaw and brows move and then a corner of the mouth, on the rig."""
    from acting import make_acting

    rise, none = np.linspace(0, 1, 6), np.zeros(6)
    bpy.context.view_layer.objects.active = rig

    def bake(name: str, share: float) -> bpy.types.Object:
        values = {f"frontalis_medial.{side}": np.r_[share * rise, none] for side in "LR"}
        values |= {"jaw_open": np.r_[share * rise, none], "zygomaticus_major.L": np.r_[none, rise]}
        path = tmp_path / f"{name}.npz"
        make_acting(values).save(path)
        scene.mimetic.performance_path = str(path)
        assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
        return rig

    return bake


def moved(armature, name: str) -> float:
    """By how much a bone leaves its rest at most."""
    poses = []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        poses.append(np.array(armature.pose.bones[name].matrix_basis))
    return float(np.abs(np.array(poses) - np.eye(4)).max())


def test_a_take_that_waited_names_what_it_lacks(bake_rig):
    bake_rig("hero", 0.7)
    armature = bake_rig("two", 0.3)
    bpy.ops.mimetic.play_take(take="hero")
    assert result()["message"] == "hero plays on Rig"
    bpy.ops.mimetic.play_take(take="two")
    armature.data.bones["jaw"].name = "kiefer"
    bpy.ops.mimetic.play_take(take="hero")
    told = (
        "Rig has no bone jaw any more, which hero moves: give it its name again, or bake the take"
    )
    assert told in result()["message"]
    armature.data.bones["kiefer"].name = "jaw"
    bpy.ops.mimetic.play_take(take="two")
    bpy.ops.mimetic.play_take(take="hero")
    assert result()["message"] == "hero plays on Rig" and moved(armature, "jaw") > 0.05


def test_a_renamed_bone_is_at_rest_in_the_next_take_and_that_is_no_edit(extension, bake_rig):
    armature = bake_rig("hero", 0.7)
    armature.data.bones["jaw"].name = "kiefer"
    assert moved(armature, "kiefer") > 0.05  # Blender follows the name in what plays
    assert not extension("scene_out").take_list.is_edited(armature.mimetic.takes["hero"])
    bake_rig("two", 0.3)
    assert rows(armature) == ["hero", "two"] and "edited" not in result()["message"]
    assert moved(armature, "kiefer") == 0 and moved(armature, "lips.L") > 0.001


def test_curves_of_a_renamed_bone_that_were_edited_stay(extension, bake_rig):
    armature = bake_rig("hero", 0.7)
    armature.data.bones["jaw"].name = "kiefer"
    for curve in extension("compat").curves(armature).fcurves:
        if "kiefer" in curve.data_path:
            curve.keyframe_points[3].co.y += 0.1
    bake_rig("two", 0.3)
    assert "hero was edited" in result()["message"] and moved(armature, "kiefer") > 0.05


def test_curves_that_two_bones_exchange_are_an_edit(extension, bake_rig):
    armature = bake_rig("hero", 0.7)
    take_list = extension("scene_out").take_list
    row, key_table = armature.mimetic.takes["hero"], extension("scene_out.key_table")
    holder = extension("compat").curves(armature)
    left, right = (
        holder.fcurves.find(f'pose.bones["lips.{side}"].location', index=2) for side in "LR"
    )
    assert left is not None and right is not None
    tables = key_table.read(left), key_table.read(right)
    assert not take_list.is_edited(row)
    key_table.write(left, tables[1])
    key_table.write(right, tables[0])
    assert take_list.is_edited(row)


def test_a_mark_of_before_holds(extension, bake_rig):
    """Files of earlier versions have marks with the names of bones."""
    row = bake_rig("hero", 0.7).mimetic.takes["hero"]
    take_list = extension("scene_out").take_list
    assert row.mark != take_list.mark_of(row, has_bones=True)
    row.mark = take_list.mark_of(row, has_bones=True)
    assert not take_list.is_edited(row)
