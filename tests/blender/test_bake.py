# SPDX-License-Identifier: GPL-3.0-or-later
"""What is baked is what was captured."""

import dataclasses

import bpy
import numpy as np
import pytest
from last_result import result

METRES = 2e-6  # single precision at arm's length, over some forty shapes


def evaluated_vertices(face, frame: float) -> np.ndarray:
    """Control vertices in the world at a scene frame, as Blender evaluates them."""
    scene = bpy.context.scene
    whole = int(np.floor(frame))
    scene.frame_set(whole, subframe=frame - whole)
    for modifier in face.modifiers:
        modifier.show_viewport = False
    evaluated = face.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.empty(len(face.data.vertices) * 3, dtype=np.float32)
    evaluated.data.vertices.foreach_get("co", points)
    matrix = np.array(evaluated.matrix_world)
    return points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]


def world_from_camera_points(points: np.ndarray) -> np.ndarray:
    """Camera frame (x right, y down, z forward) to a world whose camera looks along +y."""
    return np.column_stack([points[:, 0], points[:, 2], -points[:, 1]])


@pytest.fixture
def baked(extension, scene, performance):
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, performance, "take")
    return scene.mimetic.face


def test_the_evaluated_surface_is_the_captured_one(baked, performance):
    for i in (0, 7, 20, 39):
        expected = world_from_camera_points(performance.surface_in_camera(i))
        actual = evaluated_vertices(baked, performance.frame[i])
        assert np.abs(actual - expected).max() < METRES


def test_every_shape_has_a_curve_with_a_key_a_frame(baked, performance, extension):
    keys = baked.data.shape_keys
    names = [*performance.muscles, *performance.articulators]
    groups = [shape.name for shape in baked.mimetic.groups]
    assert [block.name for block in keys.key_blocks] == ["Basis", *names, *groups]
    curves = extension("compat").curves(keys).fcurves
    paths = {curve.data_path for curve in curves}
    assert paths == {f'key_blocks["{name}"].value' for name in names}
    assert len(curves) == len(names)
    assert {len(curve.keyframe_points) for curve in curves} == {performance.num_frames}
    motion = extension("compat").curves(baked).fcurves
    assert len(motion) == 7
    assert keys.key_blocks["jaw_side"].slider_min <= -0.8


def test_head_rotation_does_not_flip(baked, extension):
    curves = extension("compat").curves(baked).fcurves
    rotation = np.array(
        [
            [point.co[1] for point in curve.keyframe_points]
            for curve in curves
            if curve.data_path == "rotation_quaternion"
        ]
    )
    assert (np.einsum("in,in->n", rotation[:, 1:], rotation[:, :-1]) > 0.9).all()


def test_nothing_of_the_scene_is_changed(extension, scene, performance):
    def settings():
        render = scene.render
        return (
            *(render.fps, render.fps_base, scene.frame_start, scene.frame_end),
            *(render.resolution_x, render.resolution_y, scene.frame_current),
        )

    scene.render.fps, scene.render.fps_base = 24, 1.001
    before = settings()
    extension("scene_out").bake(scene, performance, "take")
    assert settings() == before


def test_baking_again_keeps_the_take_before_and_the_face(baked, extension, scene, performance):
    keys = baked.data.shape_keys
    before = keys.animation_data.action
    extension("scene_out").bake(scene, performance, "take")
    assert scene.mimetic.face == baked
    assert len([o for o in scene.objects if o.type == "MESH"]) == 1
    assert keys.animation_data.action != before
    assert before.use_fake_user
    after = evaluated_vertices(baked, 8)
    expected = world_from_camera_points(performance.surface_in_camera(7))
    assert np.abs(after - expected).max() < METRES


def test_the_users_action_survives(baked, extension, scene, performance):
    mine = bpy.data.actions.new("mine")
    baked.animation_data.action = mine
    extension("scene_out").bake(scene, performance, "take")
    assert "mine" in bpy.data.actions
    assert mine.use_fake_user
    assert baked.animation_data.action != mine


def test_detail_is_baked_and_silenced_by_a_take_without(extension, scene, performance):
    random = np.random.default_rng(5)
    detailed = dataclasses.replace(
        performance,
        detail_modes=performance.muscle_modes[:3] * 40,
        detail_coefficients=0.02 * random.normal(size=(performance.num_frames, 3)),
    )
    scene.render.fps = 25
    extension("scene_out").bake(scene, detailed, "take")
    face = scene.mimetic.face
    expected = world_from_camera_points(detailed.surface_in_camera(11))
    assert np.abs(evaluated_vertices(face, 12) - expected).max() < METRES
    extension("scene_out").bake(scene, performance, "take")
    expected = world_from_camera_points(performance.surface_in_camera(11))
    assert np.abs(evaluated_vertices(face, 12) - expected).max() < METRES


def test_another_mesh_gets_a_face_of_its_own(baked, extension, scene, performance):
    other = dataclasses.replace(performance, faces=performance.faces[:-10])
    extension("scene_out").bake(scene, other, "take")
    assert scene.mimetic.face != baked
    assert baked.name in scene.objects


def test_a_moved_camera_takes_the_face_along(baked, extension, scene, performance):
    from mathutils import Matrix

    camera = scene.mimetic.camera
    camera.matrix_world = Matrix.Translation((1, 2, 3)) @ camera.matrix_world
    extension("scene_out").bake(scene, performance, "take")
    expected = world_from_camera_points(performance.surface_in_camera(7)) + np.array([1, 2, 3])
    assert np.abs(evaluated_vertices(baked, 8) - expected).max() < 2 * METRES


@pytest.fixture
def moved():
    """An empty that turns, enlarges and moves what hangs on it."""
    empty = bpy.data.objects.new("Set", None)
    bpy.context.scene.collection.objects.link(empty)
    empty.location, empty.rotation_euler, empty.scale = (3, 1, 0.5), (0.2, 0.1, 0.5), (2, 2, 2)
    return empty


def points_in_camera(face, frame: int) -> np.ndarray:
    """As `evaluated_vertices`, but in the frame of the footage's camera; its scale counts."""
    points = evaluated_vertices(face, frame)
    camera = np.array(bpy.context.scene.mimetic.camera.matrix_world.inverted())
    return points @ camera[:3, :3].T + camera[:3, 3]


@pytest.mark.parametrize("use_controls", [False, True])
@pytest.mark.parametrize("is_parent", [False, True])
def test_a_face_stays_before_its_camera_when_both_were_moved(
    extension, scene, performance, moved, use_controls, is_parent
):
    extension("scene_out").bake(scene, performance, "take", use_controls=use_controls)
    face, camera = scene.mimetic.face, scene.mimetic.camera
    head = face.mimetic.control_object or face
    expected = {frame: points_in_camera(face, frame) for frame in (1, 20, 40)}
    if is_parent:
        head.parent = camera.parent = moved
    else:
        bpy.context.view_layer.update()
        matrix = moved.matrix_world.normalized()
        for obj in {head, camera} - {face}:
            obj.matrix_world = matrix @ obj.matrix_world
    bpy.context.view_layer.update()
    summary = extension("scene_out").bake(scene, performance, "again", use_controls=use_controls)
    for frame, points in expected.items():
        np.testing.assert_allclose(points_in_camera(face, frame), points, atol=4 * METRES)
    assert not summary.remark


def test_a_control_object_is_made_before_the_camera_whatever_frame_is_shown(
    extension, scene, baked, performance
):
    expected = evaluated_vertices(baked, 8)
    scene.frame_set(20)
    extension("scene_out").bake(scene, performance, "again", use_controls=True)
    np.testing.assert_allclose(evaluated_vertices(baked, 8), expected, atol=4 * METRES)


@pytest.mark.parametrize("to", ["KEYS", "CONTROLS"])
@pytest.mark.parametrize("with_camera", [False, True])
def test_a_parent_that_is_animated_is_told_unless_the_camera_goes_along(
    bake, scene, performance, moved, to, with_camera
):
    face = bake(performance, to=to)
    expected = {frame: points_in_camera(face, frame) for frame in (9, 30)}
    for obj in (face.mimetic.control_object or face, *[scene.mimetic.camera] * with_camera):
        obj.parent = moved
    moved.scale = (1, 1, 1)
    moved.keyframe_insert("location", frame=1)
    moved.location.x += 1
    moved.keyframe_insert("location", frame=40)
    scene.frame_set(9)
    bake(performance, "again", to=to)
    told = f"Set is animated and moves {face.name}, which is before its footage in frame 9 alone"
    assert (told in result()["message"]) != with_camera
    for frame in (9, 30) if with_camera else (9,):
        np.testing.assert_allclose(points_in_camera(face, frame), expected[frame], atol=8 * METRES)


def test_a_parent_that_is_flat_changes_nothing(extension, scene, baked, performance, moved):
    baked.parent = moved
    moved.scale = (0, 1, 1)
    action = baked.animation_data.action
    with pytest.raises(Exception, match="flat"):
        extension("scene_out").bake(scene, performance, "again")
    assert baked.animation_data.action == action
    assert "again head" not in bpy.data.actions


def test_detail_is_baked_when_asked_for(extension, scene, performance):
    modes = 1e-3 * np.cos(np.arange(3 * performance.neutral_vertices.size)).reshape(3, -1, 3)
    rates = np.linspace(-1.5, 2.5, performance.num_frames)
    coefficients = np.stack([rates, rates**2, -rates], axis=1)
    whole = dataclasses.replace(performance, detail_modes=modes, detail_coefficients=coefficients)
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, whole, "take")
    face = scene.mimetic.face
    names = [block.name for block in face.data.shape_keys.key_blocks]
    assert {"detail.000", "detail.001", "detail.002"} <= set(names)
    expected = world_from_camera_points(whole.surface_in_camera(20))
    actual = evaluated_vertices(face, performance.frame[20])
    assert np.abs(actual - expected).max() < METRES


def test_a_face_that_the_view_layer_does_not_show_is_baked_and_that_is_said(bake, performance):
    face = bake(performance)
    hidden = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.children.link(hidden)
    for collection in face.users_collection:
        collection.objects.unlink(face)
    hidden.objects.link(face)
    bpy.context.view_layer.layer_collection.children["Hidden"].exclude = True
    assert bake(performance) == face
    assert "in no collection that this view layer shows" in result()["message"]


@pytest.mark.newest
def test_a_hidden_face_is_baked_and_that_is_said(bake, performance):
    face = bake(performance)
    assert "is hidden" not in result()["message"]
    face.hide_set(True)
    assert bake(performance) == face and face.hide_get()
    assert f"{face.name} is hidden" in result()["message"]
