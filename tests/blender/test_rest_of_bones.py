# SPDX-License-Identifier: GPL-3.0-or-later
"""What a take that ceases to play leaves at rest, where it keyed more than bones and keys."""

import bpy
import pytest

BONE = 'pose.bones["Bone"]'


@pytest.fixture
def rig(scene):
    bpy.ops.object.armature_add()
    rig = bpy.context.object
    rig.pose.bones["Bone"].constraints.new("LIMIT_ROTATION").influence = 0.25
    return rig


def keyed(extension, rig, name: str, paths: tuple[str, ...]):
    """A take of the rig, which plays, with curves at 0.5."""
    compat = extension("compat")
    action = compat.new_action(name, rig)
    for path in paths:
        curve = compat.new_curve(compat.curves(rig), path, 0, "Bone")
        curve.keyframe_points.insert(1, 0.5)
    row = rig.mimetic.takes.add()
    row.name = name
    part = row.parts.add()
    part.name, part.action = "OBJECT", action
    part.slot = compat.slot_of(rig.animation_data)
    part.handle = compat.handle_of(action, part.slot)


def test_a_keyed_constraint_hinders_no_other_take(extension, scene, rig):
    keyed(extension, rig, "first", (f"{BONE}.scale",))
    influence = f'{BONE}.constraints["Limit Rotation"].influence'
    keyed(extension, rig, "second", (f"{BONE}.location", f"{BONE}.scale", influence))
    bone = rig.pose.bones["Bone"]
    scene.frame_set(1)
    assert bone.location[0] == bone.scale[0] == bone.constraints[0].influence == 0.5
    assert bpy.ops.mimetic.play_take(take="first") == {"FINISHED"}
    assert rig.animation_data.action.name == "first"
    assert bone.location[0] == 0 and bone.scale[0] == 0.5
