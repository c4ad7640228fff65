# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's motion on objects and bones, as Blender evaluates it."""

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

FRAMES = (1, 9, 24, 40)
DEGREES = 0.02


@pytest.fixture
def rig(scene, rig_file):
    """A generated Rigify rig beside its meta-rig; the scene plays at the footage's 25 frames/s."""
    with bpy.data.libraries.load(str(rig_file)) as (source, target):
        target.objects = [name for name in source.objects if not name.startswith("WGT")]
    for loaded in target.objects:
        scene.collection.objects.link(loaded)
    scene.render.fps = 25
    return bpy.data.objects["rig"]


@pytest.fixture
def empty(scene):
    added = bpy.data.objects.new("empty", None)
    scene.collection.objects.link(added)
    scene.render.fps = 25
    return added


def bake(extension, performance, target, **settings):
    head = extension("scene_out").head
    goal = head.Target(name=target.name, **settings)
    return head.bake(bpy.context.scene, performance, "take", goal)


def world_at(target, frame: float, bone: str = "") -> np.ndarray:
    """4 x 4, of an object or of its bone, in the world."""
    whole = int(np.floor(frame))
    bpy.context.scene.frame_set(whole, subframe=frame - whole)
    evaluated = target.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = evaluated.matrix_world
    return np.array(matrix @ evaluated.pose.bones[bone].matrix if bone else matrix)


def rotation(matrix) -> np.ndarray:
    return matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)


def angle(a, b) -> float:
    """Degrees between two rotations (3 x 3)."""
    return np.degrees(2 * np.arcsin(min(1.0, np.linalg.norm(a - b) / np.sqrt(8))))


def turns(performance, calibration: int) -> np.ndarray:
    """The actor's turns since a frame (from 1), in the axes of a character that faces -y."""
    pose = performance.head_pose[:, :3, :3]
    since = pose[calibration - 1].T @ pose
    axes = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # character from head
    return axes @ since @ axes.T


@pytest.mark.parametrize("follow", [0.0, 0.5, 1.0])
def test_a_rigify_head_turns_as_the_actors(extension, performance, rig, follow):
    rig.pose.bones["torso"]["head_follow"] = follow
    rig.update_tag()
    bpy.context.view_layer.update()
    rest = rotation(world_at(rig, 1, "head")), rotation(world_at(rig, 1, "neck"))
    bake(
        extension,
        performance,
        rig,
        bone="head",
        neck="neck",
        neck_share=0.4,
        rest_frame=5,
        translation_scale=0.0,
    )
    expected = turns(performance, 5)
    for frame in FRAMES:
        turned = rotation(world_at(rig, frame, "head")) @ rest[0].T
        assert angle(turned, expected[frame - 1]) < DEGREES, frame
        whole = angle(expected[frame - 1], np.eye(3))
        of_neck = angle(rotation(world_at(rig, frame, "neck")) @ rest[1].T, np.eye(3))
        assert of_neck == pytest.approx(0.4 * whole, abs=DEGREES)
    deform = rotation(world_at(rig, 5, "DEF-spine.006"))
    moved = rotation(world_at(rig, 24, "DEF-spine.006")) @ deform.T
    assert angle(moved, expected[23]) < 0.5  # the mesh's own bone goes along


@pytest.mark.parametrize("mode", ["QUATERNION", "XYZ", "ZYX", "YXZ", "AXIS_ANGLE"])
def test_every_rotation_mode_turns_alike(extension, performance, rig, mode):
    rig.pose.bones["head"].rotation_mode = mode
    rest = rotation(world_at(rig, 1, "head"))
    bake(extension, performance, rig, bone="head", rest_frame=1, translation_scale=0.0)
    assert rig.pose.bones["head"].rotation_mode == mode
    for frame in (9, 24, 24.5):
        turned = rotation(world_at(rig, frame, "head")) @ rest.T
        i = int(frame) - 1
        # Halfway between two keys a rotation is between theirs in every mode: no jumps
        limit = DEGREES + (frame % 1) * 2 * angle(*turns(performance, 1)[i : i + 2])
        assert angle(turned, turns(performance, 1)[i]) < limit


def test_an_armature_that_stands_turned_and_scaled_turns_its_head_alike(
    extension, performance, rig
):
    rig.matrix_world = Matrix.Translation((1, 2, 3)) @ Euler((0, 0, 2.0)).to_matrix().to_4x4() * 2
    bpy.context.view_layer.update()
    rest, stands = rotation(world_at(rig, 1, "head")), rotation(np.array(rig.matrix_world))
    bake(extension, performance, rig, bone="head", rest_frame=3, translation_scale=0.0)
    turned = rotation(world_at(rig, 20, "head")) @ rest.T
    assert angle(turned, stands @ turns(performance, 3)[19] @ stands.T) < DEGREES


def test_a_moving_head_bone_keeps_the_actors_way(extension, performance, rig):
    start = world_at(rig, 1, "head")
    bake(extension, performance, rig, bone="head", rest_frame=1, translation_scale=0.5)
    points = performance.head_pose[:, :3, 3]
    way = (points[30] - points[0]) @ performance.head_pose[0, :3, :3]
    moved = world_at(rig, 31, "head")[:3, 3] - start[:3, 3]
    np.testing.assert_allclose(moved, 0.5 * way[[0, 2, 1]] * [1, -1, 1], atol=1e-5)


def test_other_curves_go_on_and_the_action_before_stays(extension, performance, rig):
    bones = rig.pose.bones
    bones["hips"].keyframe_insert("location", frame=1)
    bones["hips"].location.x = 0.3
    bones["hips"].keyframe_insert("location", frame=30)
    bones["head"].keyframe_insert("rotation_quaternion", frame=1)
    before = rig.animation_data.action
    bake(extension, performance, rig, bone="head", neck="neck", neck_share=0.5)
    after = rig.animation_data.action
    assert after != before and before.use_fake_user
    curves = extension("compat").curves(rig).fcurves
    paths = [curve.data_path for curve in curves]
    assert paths.count('pose.bones["hips"].location') == 3
    assert paths.count('pose.bones["head"].rotation_quaternion') == 4
    assert paths.count('pose.bones["neck"].rotation_quaternion') == 4
    bpy.context.scene.frame_set(30)
    assert bones["hips"].location.x == pytest.approx(0.3)
    first = [c for c in curves if c.data_path == 'pose.bones["head"].rotation_quaternion']
    assert {len(curve.keyframe_points) for curve in first} == {performance.num_frames}


def test_the_neck_is_tried_out_under_curves_of_its_own(extension, performance, rig):
    """What the head inherits is found by turning the neck: curves and pose must not stand by."""
    rig.pose.bones["torso"]["head_follow"] = 1.0
    neck = rig.pose.bones["neck"]
    neck.keyframe_insert("rotation_quaternion", frame=1)
    neck.rotation_quaternion = Euler((0.3, 0.2, 0)).to_quaternion()
    before = neck.rotation_quaternion.copy()
    assert extension("scene_out").rigs.followed_share(rig, "head", "neck") == pytest.approx(
        1, abs=1e-3
    )
    assert neck.rotation_quaternion == before


def test_bones_are_found_by_name_and_a_metarig_is_told_apart(extension, rig):
    rigs = extension("scene_out").rigs
    result = rigs.head_bones(rig)
    assert (result.head, result.neck, result.remark) == ("head", "neck", "")
    assert "Generate" in rigs.head_bones(bpy.data.objects["metarig"]).remark


def test_an_empty_moves_on_from_where_it_is(extension, performance, empty, scene):
    parent = bpy.data.objects.new("parent", None)
    scene.collection.objects.link(parent)
    parent.matrix_world = Matrix.Translation((0, 5, 0)) @ Euler((0.4, 0.2, 1)).to_matrix().to_4x4()
    empty.parent = parent
    empty.location, empty.rotation_euler = (1, 2, 3), (0.1, 0.2, 0.3)
    bpy.context.view_layer.update()
    start = world_at(empty, 1)
    bake(extension, performance, empty, rest_frame=1)
    np.testing.assert_allclose(world_at(empty, 1), start, atol=1e-5)
    axes = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    pose = np.linalg.inv(performance.head_pose[0]) @ performance.head_pose[25]
    expected = start.copy()
    expected[:3, :3] = start[:3, :3] @ axes @ pose[:3, :3] @ axes.T
    expected[:3, 3] += start[:3, :3] @ axes @ pose[:3, 3]
    np.testing.assert_allclose(world_at(empty, 26), expected, atol=1e-5)


def test_a_mirrored_object_stands_at_rest_as_it_did_and_looks_as_it_is_seen_to(
    extension, performance, empty
):
    empty.rotation_euler = (0, 0, 0.5)
    empty.scale = (-0.5, 0.5, 0.5)
    bpy.context.view_layer.update()
    start = world_at(empty, 1)
    bake(extension, performance, empty, rest_frame=1)
    np.testing.assert_allclose(world_at(empty, 1), start, atol=1e-5)
    axes = np.array(Euler((0, 0, 0.5)).to_matrix())
    turned = world_at(empty, 26)[:3, :3] @ np.linalg.inv(start[:3, :3])
    assert angle(turned, axes @ turns(performance, 1)[25] @ axes.T) < DEGREES


@pytest.mark.parametrize("bone", ["", "head"])
def test_a_scene_of_centimetres_moves_it_a_hundred_units_a_metre(
    extension, performance, rig, empty, scene, bone
):
    ways = []
    for scale in (1.0, 0.01):
        scene.unit_settings.scale_length = scale
        target = rig if bone else empty
        bake(extension, performance, target, bone=bone, rest_frame=1)
        ways.append(world_at(target, 31, bone)[:3, 3] - world_at(target, 1, bone)[:3, 3])
    np.testing.assert_allclose(0.01 * ways[1], ways[0], atol=1e-5)
    assert np.linalg.norm(ways[0]) > 0.005


def test_as_filmed_an_object_is_where_the_baked_face_is(extension, performance, empty, scene):
    extension("scene_out").bake(scene, performance, "take")
    bake(extension, performance, empty, is_absolute=True)
    for frame in FRAMES:
        face = world_at(scene.mimetic.face, frame)
        np.testing.assert_allclose(world_at(empty, frame), face, atol=1e-5)


def test_keys_keep_to_the_seconds_and_the_scenes_rate_stays(extension, performance, empty, scene):
    scene.render.fps, scene.render.fps_base = 24, 1.001
    baked = bake(extension, performance, empty)
    assert (scene.render.fps, round(scene.render.fps_base, 4)) == (24, 1.001)
    assert baked.first == 1
    assert baked.last == pytest.approx(1 + 39 / 25 * 24 / 1.001)


def test_a_frame_that_is_missing_changes_nothing(extension, performance, empty):
    from mimetic import InvalidInput

    with pytest.raises(InvalidInput, match="frame 999"):
        bake(extension, performance, empty, rest_frame=999)
    assert empty.animation_data is None
    assert not bpy.data.actions


def test_the_button_keys_the_chosen_bones(extension, performance_file, rig, scene):
    settings = scene.mimetic.head
    assert not bpy.ops.mimetic.bake_head.poll()
    scene.mimetic.performance_path = str(performance_file)
    settings.target = rig
    assert (settings.bone, settings.neck, settings.use_translation) == ("head", "neck", False)
    assert bpy.ops.mimetic.bake_head() == {"FINISHED"}
    paths = {curve.data_path for curve in extension("compat").curves(rig).fcurves}
    assert paths == {f'pose.bones["{name}"].rotation_quaternion' for name in ("head", "neck")}
    settings.bone = "nose"
    assert not bpy.ops.mimetic.bake_head.poll()


@pytest.mark.parametrize(
    ("name", "settings", "said"),
    [
        ("metarig", {}, "Generate"),
        ("rig", {"bone": "nose"}, "no bone nose"),
        ("rig", {"bone": "neck"}, "the head's own bone"),
        ("rig", {"smoothing": -1.0}, "smoothing"),
    ],
    ids=["metarig", "bone", "same", "smoothing"],
)
def test_a_file_without_such_bones_is_refused(
    extension, performance_file, rig_file, tmp_path, name, settings, said
):
    from mimetic import InvalidInput

    write = extension("scene_out.rig_file").write
    usual = {"bone": None, "neck": None, "neck_share": 0.3, "smoothing": 0.5}
    out = tmp_path / "moved.blend"
    with pytest.raises(InvalidInput, match=said):
        write(str(performance_file), str(out), str(rig_file), name, usual | settings)
    assert list(tmp_path.iterdir()) == []
