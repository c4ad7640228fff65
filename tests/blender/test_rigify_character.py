# SPDX-License-Identifier: GPL-3.0-or-later
"""A Rigify human with face and body: a performance plays on face, head and neck, and leaves what
moves the body alone."""

import re
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from test_bake_command import run_bake

pytestmark = pytest.mark.oldest_and_newest

FRAMES = (1, 14, 30)
HEAD, NECK = "DEF-spine.006", "DEF-spine.005"
BODY = re.compile(
    r"DEF-(spine(\.00[1-3])?$|shoulder|upper_arm|forearm|hand|palm|f_|thumb|pelvis|thigh|shin|foot|toe)"
)


@pytest.fixture(scope="module")
def character(rigify) -> Path:
    return rigify("--body")


@pytest.fixture(scope="module")
def performed(character, acted, tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("out") / "performed.blend"
    ran = run_bake(acted[1], "--out", out, "--target", f"{character}:rig", "--controls", "own")
    assert ran.returncode == 0, ran.stderr
    return out


def shown(path: Path) -> tuple[list[dict[str, Matrix]], list[np.ndarray], list[np.ndarray]]:
    """Of each frame the deform bones' places, the body's points, and the head's as its bone has
    them."""
    bpy.ops.wm.open_mainfile(filepath=str(path))
    bones, bodies, heads = [], [], []
    for frame in FRAMES:
        bpy.context.scene.frame_set(frame)
        now = bpy.context.evaluated_depsgraph_get()
        rig = bpy.data.objects["rig"].evaluated_get(now)
        bones.append({b.name: b.matrix.copy() for b in rig.pose.bones if b.bone.use_deform})
        bodies.append(points(bpy.data.objects["Body"].evaluated_get(now)))
        turned = np.array(bones[-1][HEAD].inverted())
        heads.append(points(face().evaluated_get(now)) @ turned[:3, :3].T + turned[:3, 3])
    return bones, bodies, heads


def face() -> bpy.types.Object:
    return next(obj for obj in bpy.data.objects if len(obj.mimetic.shapes))


def points(obj) -> np.ndarray:
    flat = np.empty(3 * len(obj.data.vertices), np.float32)
    obj.data.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def angle(before: Matrix, after: Matrix) -> float:
    turn = (after.to_3x3().normalized() @ before.to_3x3().normalized().inverted()).to_quaternion()
    return float(np.degrees(2 * np.arccos(min(1.0, abs(turn.w)))))


def test_face_head_and_neck_play_and_the_body_goes_on(character, performed, acted):
    bones, bodies, faces = shown(character)
    idle = curves("Idle")
    played, played_bodies, played_faces = shown(performed)
    rig = bpy.data.objects["rig"]
    body = [name for name in bones[0] if BODY.match(name)]
    assert {"DEF-hand.L", "DEF-foot.R", "DEF-spine.003"} <= set(body)
    moved = np.array(bones[1]["DEF-hand.L"]) - np.array(bones[0]["DEF-hand.L"])
    assert np.abs(moved).max() > 0.02  # the body does move
    for before, after in zip(bones, played, strict=True):
        for name in body:
            np.testing.assert_allclose(after[name], before[name], atol=1e-5, err_msg=name)
    np.testing.assert_allclose(
        points_below(played_bodies, 1.4), points_below(bodies, 1.4), atol=1e-5
    )

    turned = [
        angle(*pair)
        for pair in zip([b[HEAD] for b in bones], [p[HEAD] for p in played], strict=True)
    ]
    bent = [
        angle(*pair)
        for pair in zip([b[NECK] for b in bones], [p[NECK] for p in played], strict=True)
    ]
    assert max(turned) > 10
    assert 0.2 * max(turned) < max(bent) < 0.9 * max(turned)  # the neck takes a share
    for before, after in zip(faces, played_faces, strict=True):
        moved = np.linalg.norm(after - before, axis=1)
        assert np.percentile(moved, 99) > 0.003  # the face plays within the head

    # One take: what moved the body goes on in it, and the action that was there stays
    assert idle
    now = curves(rig.animation_data.action.name)
    assert rig.animation_data.action.name != "Idle"
    assert curves("Idle") == idle
    assert {('pose.bones["neck"].rotation_quaternion', axis) for axis in range(4)} <= now.keys()
    assert {path: keys for path, keys in now.items() if path in idle} == idle


def points_below(bodies: list[np.ndarray], height: float) -> list[np.ndarray]:
    is_below = bodies[0][:, 2] < height
    return [body[is_below] for body in bodies]


def curves(action: str) -> dict[tuple[str, int], list]:
    from importlib import import_module

    from conftest import MODULE

    compat = import_module(f"{MODULE}.compat")
    block = bpy.data.actions[action]
    slots = getattr(block, "slots", None)
    found = compat.curves_of(block, slots[0].identifier if slots else "")
    return {
        (curve.data_path, curve.array_index): [tuple(key.co) for key in curve.keyframe_points]
        for curve in found
    }
