# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes of rigs look where the performance's do: bones that eyes look at, and eyes that turn."""

import dataclasses

import bpy
import numpy as np
import pytest
from mathutils import Vector
from test_face_bones import rig  # noqa: F401

pytestmark = pytest.mark.newest

YAW = np.array([0, 20, -20, 0, 0, 15, -25, 30.0])  # degrees, to the subject's left
PITCH = np.array([0, 0, 0, 12, -18, 10, -10, 0.0])  # up
OTHER = np.array([0, 2, -1, 0, 0, 5, 3, -6.0])  # by which the right eye's yaw differs
ACROSS = 0.5  # degrees, of where an eye looks


@pytest.fixture(scope="session")
def looking():
    """Eyes that turn, in a head that does nothing else."""
    from acting import make_acting
    from mimetic.performance.gaze import GAZE, modes_with_gaze
    from mimetic.template.face_template import load_template

    template = load_template()
    still = make_acting({"jaw_open": np.zeros(len(YAW))})
    eye_of = np.zeros(len(still.neutral_vertices), dtype=np.int32)
    for eye, part in enumerate(("eye.L", "eye.R"), 1):
        eye_of[template.part_vertices(part)] = eye
    centers = np.asarray(template.eye_centers)
    return dataclasses.replace(
        still,
        articulators=[*still.articulators, *GAZE],
        articulator_values=np.column_stack(
            [still.articulator_values, YAW, PITCH, YAW + OTHER, PITCH]
        ),
        articulator_modes=modes_with_gaze(still.articulator_modes),
        eye_centers=centers,
        iris_centers=centers + np.array([0, 0, 0.012]),
        eye_of_vertex=eye_of,
        lid_following=np.tile([0.02, 0.0], (2, 1)),
    )


def directions(face) -> list[np.ndarray]:
    """Where the eyes look in each frame, N x 3 each, in the head's own frame, x to its left."""
    from mimetic.template.face_template import load_template

    template, eyes = load_template(), [[], []]
    rest = face.data.shape_keys.reference_key.points
    before = np.array([point.co for point in rest])
    for frame in range(1, len(YAW) + 1):
        bpy.context.scene.frame_set(frame)
        now = face.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices
        for found, part in zip(eyes, ("eye.L", "eye.R"), strict=True):
            rows = template.part_vertices(part)
            moved = np.array([now[int(row)].co for row in rows])
            source, target = (p - p.mean(axis=0) for p in (before[rows], moved))
            u, _, vt = np.linalg.svd(source.T @ target)
            found.append((u @ vt).T @ [0, -1, 0])
    return [np.array(found) for found in eyes]


def wanted(yaw, pitch) -> np.ndarray:
    """N x 3: where an eye looks, in the object's frame, whose face looks along -y."""
    yaw, pitch = np.radians(yaw), np.radians(pitch)
    return np.column_stack(
        [np.sin(yaw) * np.cos(pitch), -np.cos(yaw) * np.cos(pitch), np.sin(pitch)]
    )


def apart(got: np.ndarray, want: np.ndarray) -> np.ndarray:
    return np.degrees(np.arccos(np.clip((got * want).sum(axis=1), -1, 1)))


def check(face) -> None:
    left, right = directions(face)
    assert apart(left, wanted(YAW, PITCH)).max() < ACROSS
    assert apart(right, wanted(YAW + OTHER, PITCH)).max() < ACROSS


def test_the_eyes_of_rigifys_faces_look_as_the_actors_do(extension, rigify_file, looking):
    bpy.ops.wm.open_mainfile(filepath=str(rigify_file))
    bones, scene = extension("scene_out.face_bones"), bpy.context.scene
    scene.render.fps = 25
    armature = bpy.data.objects["rig"]
    played = bones.play(scene, looking, armature)
    assert not [name for name in played.unplayed if "look" in name or "gaze" in name]
    assert {"eye.L along x", "eye.L along y", "eye.R along x"} <= set(played.names)
    bones.bake(scene, looking, "look", armature, played, use_head_motion=False)
    check(bones.deformed_face(scene, armature))


def add_eyes(armature) -> None:
    """Bones at the eyes that turn them, in the rig of `test_face_bones`."""
    from mimetic.template.face_template import load_template

    template = load_template()
    face = bpy.data.objects["Hero"]
    points = np.array([point.co for point in face.data.shape_keys.reference_key.points])
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for part in ("eye.L", "eye.R"):
        bone = armature.data.edit_bones.new(part)
        middle = points[template.part_vertices(part)].mean(axis=0)
        bone.head, bone.tail = Vector(middle), Vector(middle) + Vector((0.01, -0.03, 0.005))
        bone.roll = 0.4
        bone.parent = armature.data.edit_bones["head"]
    bpy.ops.object.mode_set(mode="OBJECT")
    for part in ("eye.L", "eye.R"):
        rows = [int(row) for row in template.part_vertices(part)]
        for group in face.vertex_groups:
            if group.name in armature.data.bones:
                group.remove(rows)
        face.vertex_groups.new(name=part).add(rows, 1.0, "REPLACE")


@pytest.mark.parametrize("mode", ["QUATERNION", "XYZ"])
def test_eyes_that_turn_look_as_the_actors_do(extension, rig, scene, looking, mode):  # noqa: F811
    add_eyes(rig)
    rig.pose.bones["eye.L"].rotation_mode = mode
    bones = extension("scene_out.face_bones")
    scene.render.fps = 25
    played = bones.play(scene, looking, rig)
    bones.bake(scene, looking, "look", rig, played, use_head_motion=False)
    bpy.data.objects["Hero"].modifiers["Subdivision"].show_viewport = False
    check(bpy.data.objects["Hero"])
    paths = {curve.data_path for curve in extension("compat").curves(rig).fcurves}
    assert not any(path.endswith('"eye.L"].location') for path in paths)


def test_eyes_that_nothing_turns_are_told(extension, rig, scene, looking):  # noqa: F811
    played = extension("scene_out.face_bones").play(scene, looking, rig)
    assert {"look_in.L", "look_out.R"} <= set(played.unplayed)
