# SPDX-License-Identifier: GPL-3.0-or-later
"""Few keys on a rig's bones, face and head, play within what is said of the dense ones."""

import re

import bpy
import numpy as np
import pytest
from last_result import result
from mathutils import Matrix
from test_bake_command import run_bake
from test_face_bones import rig  # noqa: F401
from test_few_keys import RATES

pytestmark = pytest.mark.newest

FRAMES = 120
TOLERANCE = 0.02  # .2 mm, .2 degrees
SAID = re.compile(r"(\d+) keys instead of (\d+), within ([\d.e+-]+) degrees and ([\d.e+-]+) mm")


@pytest.fixture
def acting_file(tmp_path):
    """Two events of jaw, brows and lip corner, while the head turns; 25 frames a second."""
    import dataclasses

    from acting import make_acting

    frames = np.arange(FRAMES)
    event = np.clip(1.3 - ((frames - 30) / 12) ** 2, 0, 1) ** 2
    event += 0.8 * np.clip(1.2 - ((frames - 85) / 14) ** 2, 0, 1) ** 2
    acting = make_acting(
        {
            "jaw_open": 0.7 * event,
            **{f"frontalis_medial.{side}": event for side in "LR"},
            "zygomaticus_major.L": np.roll(event, 15),
        }
    )
    pose = acting.head_pose.copy()
    for one, angle in zip(pose, 0.4 * np.sin(frames / 15), strict=True):
        one[:3, :3] = np.array(Matrix.Rotation(angle, 3, (0.3, 0.9, 0.1))) @ one[:3, :3]
    path = tmp_path / "hero.npz"
    dataclasses.replace(acting, head_pose=pose).save(path)
    return path


def poses(armature, frames) -> dict[str, np.ndarray]:
    """What curves give each bone (frames x 4 x 4) at frames that need not be whole."""
    found = {bone.name: [] for bone in armature.pose.bones}
    for frame in frames:
        bpy.context.scene.frame_set(int(frame), subframe=float(frame % 1))
        for bone in armature.pose.bones:
            found[bone.name].append(np.array(bone.matrix_basis))
    return {name: np.array(rows) for name, rows in found.items()}


def apart(few, dense) -> tuple[float, float]:
    """The largest turn between two ways of bones, degrees, and shift, millimetres."""
    degrees = shift = 0.0
    for name, rows in few.items():
        turns = np.einsum("nij,nkj->nik", rows[:, :3, :3], dense[name][:, :3, :3])
        # The sine is exact where the cosine of a small angle is not
        sines = np.linalg.norm(turns - np.swapaxes(turns, 1, 2), axis=(1, 2)) / np.sqrt(8)
        degrees = max(degrees, float(np.degrees(np.arcsin(np.clip(sines, 0, 1))).max()))
        off = np.linalg.norm(rows[:, :3, 3] - dense[name][:, :3, 3], axis=1)
        shift = max(shift, 1e3 * float(off.max()))
    return degrees, shift


def rest_again(scene, armature) -> None:
    """As before the bake: what bones do to the mesh is measured about the pose that they have."""
    armature.animation_data_clear()
    scene.frame_set(1)
    for bone in armature.pose.bones:
        bone.matrix_basis.identity()
    bpy.context.view_layer.update()


def num_keys(extension, armature) -> int:
    return sum(len(curve.keyframe_points) for curve in extension("compat").curves(armature).fcurves)


@pytest.mark.parametrize("mode", ["QUATERNION", "XYZ", "AXIS_ANGLE"])
@pytest.mark.parametrize(("fps", "base"), RATES)
def test_bones_play_within_what_is_said_at_every_rate(
    extension,
    scene,
    rig,  # noqa: F811
    acting_file,
    mode,
    fps,
    base,
):
    if mode != "QUATERNION" and (fps, base) != RATES[0]:
        pytest.skip("one rate is enough for the other modes")
    scene.render.fps, scene.render.fps_base = round(fps / base), round(fps / base) * base / fps
    for bone in rig.pose.bones:
        bone.rotation_mode = mode
    bpy.ops.mimetic.load_performance(filepath=str(acting_file))
    bpy.context.view_layer.objects.active = rig
    at = 1 + np.arange(FRAMES) * fps / base / 25
    assert bpy.ops.mimetic.bake_controls() == {"FINISHED"}
    assert "instead of" not in result()["message"]
    dense, many = poses(rig, at), num_keys(extension, rig)
    rest_again(scene, rig)
    assert bpy.ops.mimetic.bake_controls(use_few_keys=True, tolerance=TOLERANCE) == {"FINISHED"}
    few = num_keys(extension, rig)
    said = SAID.search(result()["message"])
    assert (int(said[1]), int(said[2])) == (few, many)
    assert few < 0.35 * many
    degrees, mm = apart(poses(rig, at), dense)
    # Frames are single precision in curves, so a dense key is up to 1e-3 of a step beside
    assert 0 < degrees <= float(said[3]) * 1.05 + 2e-3
    assert 0 < mm <= float(said[4]) * 1.05 + 2e-3
    assert float(said[3]) <= 0.2 and float(said[4]) <= 0.2
    assert "few keys within 0.02" in rig.mimetic.takes[-1].settings


def test_parts_of_a_rotation_have_keys_at_the_same_frames(extension, rig, acting_file):  # noqa: F811
    bpy.ops.mimetic.load_performance(filepath=str(acting_file))
    bpy.context.view_layer.objects.active = rig
    assert bpy.ops.mimetic.bake_controls(use_few_keys=True) == {"FINISHED"}
    path = 'pose.bones["head"].rotation_quaternion'
    curves = [c for c in extension("compat").curves(rig).fcurves if c.data_path == path]
    frames = [[point.co.x for point in curve.keyframe_points] for curve in curves]
    assert len(frames) == 4 and 2 < len(frames[0]) < FRAMES / 3
    assert all(one == frames[0] for one in frames)


def test_the_command_makes_few_keys_on_bones_and_objects(
    extension,
    scene,
    rig,  # noqa: F811
    acting_file,
    tmp_path,
):
    empty = bpy.data.objects.new("Goal", None)
    scene.collection.objects.link(empty)
    scene.render.fps = 25
    file = tmp_path / "rig.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file), check_existing=False)
    for name, words in (("Rig", ["--controls", "own"]), ("Rig", []), ("Goal", [])):
        out = tmp_path / "out.blend"
        target = ["--out", out, "--target", f"{file}:{name}", *words]
        counts = []
        for few in ([], ["--few-keys"]):
            ran = run_bake(acting_file, *target, *few)
            assert ran.returncode == 0, ran.stderr
            assert bool(SAID.search(ran.stdout)) == bool(few)
            bpy.ops.wm.open_mainfile(filepath=str(out))
            counts.append(num_keys(extension, bpy.data.objects[name]))
        assert counts[1] < 0.5 * counts[0]
