# SPDX-License-Identifier: GPL-3.0-or-later
"""A character's own shape keys and the bones of its face, driven live and recorded."""

import bpy
import numpy as np
import pytest
from last_result import result
from mathutils import Matrix
from test_face_bones import rig  # noqa: F401
from test_live import Session, clip, curves_of, values_of  # noqa: F401
from test_own_controls import character  # noqa: F401


@pytest.fixture
def live_settings(scene, clip):  # noqa: F811
    settings = scene.mimetic.live
    settings.source, settings.clip_path, settings.driven = "CLIP", str(clip), "CONTROLS"
    return settings


def test_known_names_move_live_and_are_put_back(character, live_settings, extension):  # noqa: F811
    keys = character.data.shape_keys.key_blocks
    keys["mouthSmileLeft"].value, keys["Hair"].value = 0.25, 0.5
    driven, seen = Session(extension), []
    driven.run(60, lambda: seen.append(keys["mouthSmileLeft"].value))
    driven.stop()
    assert driven.session.thread.error is None
    assert np.ptp(seen) > 0.2 and keys["Hair"].value == 0.5
    driven.session.end()
    driven.session.puppet.restore()
    assert keys["mouthSmileLeft"].value == pytest.approx(0.25)


@pytest.mark.oldest_and_newest
def test_a_take_lies_on_the_characters_own_keys(scene, character, live_settings, extension):  # noqa: F811
    scene.frame_set(50)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    curves = curves_of(extension, character.data.shape_keys)
    smile = curves['key_blocks["mouthSmileLeft"].value', 0]
    assert smile.keyframe_points[0].co[0] == pytest.approx(50)
    assert np.ptp(values_of(smile)) > 0.2
    assert ('key_blocks["Hair"].value', 0) not in curves
    assert result()["object"] == character.name and len(result()["takes"]) == 1
    # What was shown is what a bake of the same take would show
    from mimetic.performance.document import Performance

    played = extension("scene_out.own_controls").play(
        Performance.load(result()["takes"][0]), character
    )
    np.testing.assert_allclose(
        values_of(smile), played.values[:, played.names.index("mouthSmileLeft")], atol=1e-5
    )


@pytest.mark.oldest_and_newest
def test_bones_of_a_rig_move_live_and_are_keyed(scene, rig, live_settings, extension):  # noqa: F811
    bpy.context.view_layer.objects.active = rig
    before = {bone.name: bone.matrix_basis.copy() for bone in rig.pose.bones}
    head = rig.pose.bones["head"]
    driven, seen, turns = Session(extension), [], []

    def look():
        seen.append([tuple(b.location) for b in rig.pose.bones])
        turns.append(tuple(head.rotation_quaternion))

    driven.run(90, look)
    driven.stop()
    assert driven.session.thread.error is None
    # A machine at its limit leaves pictures out, and with them much of the motion
    assert np.ptp(np.array(seen), axis=0).max() > 2e-4
    assert np.ptp(np.array(turns), axis=0).max() > 2e-4
    driven.session.end()
    driven.session.puppet.restore()
    assert all(bone.matrix_basis == before[bone.name] for bone in rig.pose.bones)
    assert bpy.ops.mimetic.live() == {"FINISHED"}
    curves = curves_of(extension, rig)
    assert any("lips" in path for path, _ in curves)
    keyed = [values_of(curves['pose.bones["head"].rotation_quaternion', k]) for k in range(4)]
    assert keyed[0][0] == pytest.approx(1, abs=1e-3) and np.ptp(keyed, axis=1).max() > 0.002


def test_a_rigs_head_turns_as_a_live_head_does(scene, rig, extension):  # noqa: F811
    target = extension("scene_out.face_bones").head_target(rig)
    bones = extension("scene_out.live_bones").LiveHeadBones(rig, target)
    turn, faced = np.eye(4), np.eye(4)
    faced[:3, :3], faced[2, 3] = np.diag([1.0, -1, -1]), 0.6
    turn[:3, :3] = np.array(Matrix.Rotation(np.radians(20), 3, "Y"))
    bones.show(rig, faced)
    bones.show(rig, turn @ faced)
    bpy.context.view_layer.update()
    head = rig.pose.bones["head"]
    turned = head.matrix.to_quaternion() @ head.bone.matrix_local.to_quaternion().inverted()
    assert np.degrees(turned.angle) == pytest.approx(20, abs=1e-3)
    assert abs(turned.axis.z) == pytest.approx(1, abs=1e-4)
    bones.rest = None
    bones.show(rig, turn @ faced)  # at rest now
    assert head.rotation_quaternion.angle == pytest.approx(0, abs=1e-5)


def test_without_a_character_the_button_is_grey(scene, live_settings):
    assert not bpy.ops.mimetic.live.poll()
