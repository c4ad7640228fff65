# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes turn in Blender and in glTF as they turn in the performance."""

import dataclasses

import bpy
import numpy as np
import pytest
from test_bake import METRES, evaluated_vertices, world_from_camera_points

TOLERANCE = 2e-3  # of a weight that the exporter samples


@pytest.fixture
def looking(performance):
    """The performance with eyes that look about by up to 35 degrees."""
    from mimetic.performance.gaze import GAZE
    from mimetic.template.face_template import load_template

    template = load_template()
    centers, radius = template.eye_spheres(template.vertices)
    eye_of = np.zeros(len(template.vertices), int)
    for eye, side in enumerate("LR"):
        eye_of[template.part_vertices(f"eye.{side}")] = eye + 1
    t = np.linspace(0, 6, performance.num_frames)
    angles = np.stack([35 * np.sin(t), 20 * np.cos(t), 33 * np.sin(t), 20 * np.cos(t)], axis=1)
    modes = performance.articulator_modes
    return dataclasses.replace(
        performance,
        articulators=[*performance.articulators, *GAZE],
        articulator_values=np.hstack([performance.articulator_values, angles]),
        articulator_modes=np.concatenate([modes, np.zeros_like(modes[:4])]),
        eye_centers=centers,
        iris_centers=centers + np.array([0, 0, radius]),
        eye_of_vertex=eye_of,
        lid_following=np.tile([0.02, 1.0], (2, 1)),
    )


def test_eyes_turn_as_captured(extension, scene, looking):
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, looking, "take")
    for i in (0, 9, 25, 39):
        expected = world_from_camera_points(looking.surface_in_camera(i))
        actual = evaluated_vertices(scene.mimetic.face, looking.frame[i])
        assert np.abs(actual - expected).max() < METRES


def test_sliders_in_degrees_read_and_turn_an_eye(extension, scene, looking):
    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, looking, "take")
    face = scene.mimetic.face
    scene.frame_set(int(looking.frame[9]))
    yaw, pitch = np.radians(looking.articulator_values[9, -4:-2])
    assert face.mimetic.gaze_yaw_left == pytest.approx(yaw, abs=1e-4)
    assert face.mimetic.gaze_pitch_left == pytest.approx(pitch, abs=1e-4)
    face.mimetic.gaze_yaw_left = 0.3
    assert face.mimetic.gaze_yaw_left == pytest.approx(0.3, abs=1e-5)
    assert face.mimetic.gaze_pitch_left == pytest.approx(pitch, abs=1e-4)
    keys = face.data.shape_keys.key_blocks
    assert keys["eye_left.L"].value == pytest.approx(np.sin(0.3) * np.cos(pitch), abs=1e-5)


def test_an_upper_lid_goes_along_with_the_slider_and_stays_shut(extension, scene, looking):
    extension("scene_out").bake(scene, looking, "take")
    face = scene.mimetic.face
    lid = face.data.shape_keys.key_blocks["lid_upper.R"]
    face.mimetic.gaze_pitch_right = np.radians(1.0)
    lid.value = 0.1
    face.mimetic.gaze_pitch_right = np.radians(-19.0)
    assert lid.value == pytest.approx(0.1 + 0.4 * 0.9, abs=1e-4)
    face.mimetic.gaze_pitch_right = np.radians(1.0)
    assert lid.value == pytest.approx(0.1, abs=1e-4)
    lid.slider_max = lid.value = 1.0
    face.mimetic.gaze_pitch_right = np.radians(20.0)
    assert lid.value == pytest.approx(1.0, abs=1e-4)


def test_a_face_without_gaze_has_sliders_at_rest(extension, scene, performance):
    extension("scene_out").bake(scene, performance, "take")
    face = scene.mimetic.face
    assert face.mimetic.gaze_yaw_left == 0
    face.mimetic.gaze_yaw_left = 0.3
    assert face.mimetic.gaze_yaw_left == 0


def test_gltf_turns_the_eyes_by_morph_targets(extension, scene, looking, tmp_path):
    from mimetic.character import gltf
    from mimetic.character.gaze_shapes import TURNS, turn_weights

    scene.render.fps, scene.render.fps_base = 25, 1.0
    extension("scene_out").bake(scene, looking, "take")
    extension("scene_out.gltf").export(scene, tmp_path / "face.glb")
    seconds, weights, names = gltf.read_weights((tmp_path / "face.glb").read_bytes())
    frames = np.round(seconds * 25).astype(int)
    angles = np.ascontiguousarray(looking.articulator_values[:, -4:][frames])
    expected = turn_weights(angles[:, 0], angles[:, 1])
    for name, values in zip(TURNS, expected.T, strict=True):
        actual = weights[:, names.index(f"{name}.L")].copy()
        if f"{name}.L.negative" in names:
            actual -= weights[:, names.index(f"{name}.L.negative")]
        np.testing.assert_allclose(actual, values, atol=TOLERANCE)


def test_a_canonical_head_looks_by_its_own_sliders(extension, scene, looking):
    scene.render.fps, scene.render.fps_base = 25, 1.0
    out = extension("scene_out")
    bpy.ops.mimetic.add_face()
    head = bpy.context.active_object
    summary = out.bound.bake(scene, looking, "take", head)
    assert not any("look_" in remark for remark in summary.left_out)
    scene.frame_set(int(looking.frame[9]))
    yaw = looking.articulator_values[9, -4]
    look = head.data.shape_keys.key_blocks["look_out.L" if yaw > 0 else "look_in.L"]
    assert look.value == pytest.approx(min(1.0, abs(yaw) / 35), abs=1e-3)


def test_eyes_that_are_nodes_turn_as_the_shapes_do(extension, scene, looking, tmp_path):
    """Read back from a .glb: all vertices where the face with shapes has them, and two nodes."""
    scene.render.fps, scene.render.fps_base = 25, 1.0
    rows = slice(0, 12)
    fields = ("frame", "head_pose", "head_pose_cov", "activations", "activations_std", "quality")
    fields += ("articulator_values",)
    short = dataclasses.replace(
        looking, **{name: np.asarray(getattr(looking, name))[rows] for name in fields}
    )
    eye_of = np.asarray(short.eye_of_vertex)
    still = {
        name: np.where((eye_of == 0)[:, None], getattr(short, name), 0).astype(np.float32)
        for name in ("muscle_modes", "articulator_modes")
    }
    short = dataclasses.replace(short, **still)
    extension("scene_out").bake(scene, short, "take")
    face = scene.mimetic.face
    frames = (1, 5, 11)
    expected = [evaluated_vertices(face, frame) for frame in frames]
    eyes = extension("scene_out.eye_nodes").split(scene, short, None, "take")
    assert not any(key.name.startswith("eye_") for key in face.data.shape_keys.key_blocks)
    path = tmp_path / "face.glb"
    extension("scene_out.gltf").export(scene, path, face)
    for frame, points in zip(frames, expected, strict=True):
        for number, obj in enumerate((face, *eyes)):
            actual = evaluated_vertices(obj, frame)
            assert np.abs(actual - points[eye_of == number]).max() < METRES
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 25
    bpy.ops.import_scene.gltf(filepath=str(path))
    nodes = {obj.name: obj for obj in bpy.context.scene.objects if obj.type == "MESH"}
    assert {"Eye.L", "Eye.R"} < nodes.keys()
    for i, frame in enumerate(frames):
        bpy.context.scene.frame_set(frame - 1)  # the importer's first frame is 0
        for number, name in enumerate(("Eye.L", "Eye.R")):
            assert nodes[name].parent is not None
            actual = nodes[name].matrix_world.translation
            middle = expected[i][eye_of == number + 1].mean(axis=0)
            assert np.linalg.norm(np.array(actual) - middle) < 2e-3
            looks = np.array(nodes[name].matrix_local.to_3x3()) @ [0, -1, 0]
            yaw, pitch = np.radians(short.articulator_values[frame - 1, -4:][2 * number :][:2])
            ahead = [np.sin(yaw) * np.cos(pitch), -np.cos(yaw) * np.cos(pitch), np.sin(pitch)]
            np.testing.assert_allclose(looks, ahead, atol=1e-3)


@pytest.mark.parametrize("has_gaze", [True, False])
def test_another_performance_brings_its_own_gaze(extension, scene, looking, performance, has_gaze):
    scene_out = extension("scene_out")
    scene.render.fps, scene.render.fps_base = 25, 1.0
    scene_out.bake(scene, looking, "first")
    face = scene.mimetic.face
    other = performance
    if has_gaze:
        values = looking.articulator_values.copy()
        values[:, -4:] *= -0.5
        other = dataclasses.replace(looking, articulator_values=values)
    summary = scene_out.bound.bake(scene, other, "second", face)
    assert not any("no slider" in remark for remark in summary.left_out)
    assert any("gaze on" in remark for remark in summary.left_out) != has_gaze
    curves = {row.shape: row.curve for row in scene_out.face_curves.of(face)}
    if not has_gaze:
        assert not any(shape.startswith("eye_") for shape in curves)
    for eye, side in enumerate("LR" if has_gaze else ""):
        yaw, pitch = other.articulator_values[:, -4:].T[2 * eye : 2 * eye + 2]
        weights = extension("native").gaze_shapes().turn_weights(yaw, pitch)[:, 1]
        played = [curves[f"eye_left.{side}"].evaluate(frame) for frame in other.frame]
        np.testing.assert_allclose(played, weights, atol=1e-5)
