# SPDX-License-Identifier: GPL-3.0-or-later
"""Few keys with handles play as the dense ones, and each can be dragged alone."""

import dataclasses

import bpy
import numpy as np
import pytest
from last_result import result

TOLERANCE = 0.02
RATES = ((24000, 1001), (25, 1), (30000, 1001), (30, 1), (60, 1))
FRAMES = 200


@pytest.fixture
def smiling(performance):
    """Two events of every muscle, far from each other, at 30 frames a second."""
    frames = np.arange(FRAMES)
    event = np.clip(1.3 - ((frames - 34) / 12) ** 2, 0, 1) ** 2
    event += 0.8 * np.clip(1.2 - ((frames - 88) / 14) ** 2, 0, 1) ** 2
    peaks = 0.5 + 0.5 * np.arange(36) / 36
    repeat = np.arange(FRAMES) % performance.num_frames
    return dataclasses.replace(
        performance,
        frame=np.arange(1, FRAMES + 1),
        fps=30.0,
        activations=event[:, None] * peaks,
        activations_std=np.full((FRAMES, 36), 0.05),
        articulator_values=np.zeros((FRAMES, len(performance.articulators))),
        head_pose=performance.head_pose[repeat],
        head_pose_cov=performance.head_pose_cov[repeat],
        quality=np.ones(FRAMES),
    )


def muscle_curves(extension, scene):
    """Of the face's shapes, by name."""
    keys = scene.mimetic.face.data.shape_keys
    curves = extension("compat").curves(keys).fcurves
    return {curve.data_path.split('"')[1]: curve for curve in curves}


def worst(curves, performance, scene_rate) -> float:
    """How far muscles' curves are from the activations, at the performance's own frames."""
    scale = scene_rate / performance.fps
    at = 1 + (performance.frame - 1) * scale
    columns = zip(performance.muscles, performance.activations.T, strict=True)
    return max(
        float(np.abs([curves[name].evaluate(t) for t in at] - values).max())
        for name, values in columns
    )


@pytest.mark.parametrize(("fps", "base"), RATES)
def test_few_keys_play_the_same_at_every_rate(extension, scene, smiling, fps, base):
    scene.render.fps, scene.render.fps_base = round(fps / base), round(fps / base) * base / fps
    extension("scene_out").bake(scene, smiling, "take", tolerance=TOLERANCE)
    curves = muscle_curves(extension, scene)
    assert worst(curves, smiling, fps / base) <= TOLERANCE + 1e-4
    dense = len(curves) * FRAMES
    assert sum(len(curve.keyframe_points) for curve in curves.values()) <= 0.1 * dense


def test_a_drag_of_one_key_changes_one_event_only(extension, scene, smiling):
    scene.render.fps, scene.render.fps_base = 30, 1.0
    extension("scene_out").bake(scene, smiling, "take", tolerance=TOLERANCE)
    curve = muscle_curves(extension, scene)[smiling.muscles[0]]
    before = np.array([curve.evaluate(t) for t in range(1, FRAMES + 1)])
    key = max(
        (point for point in curve.keyframe_points if point.co.x < 60), key=lambda point: point.co.y
    )
    at = round(key.co.x)
    key.co_ui = (key.co.x, key.co.y + 0.2)  # as a drag does: the handles come along
    curve.update()
    change = np.array([curve.evaluate(t) for t in range(1, FRAMES + 1)]) - before
    assert change[at - 1] == pytest.approx(0.2, abs=1e-4)
    assert np.abs(change[60:]).max() < 1e-6
    assert np.abs(change[:15]).max() < 1e-6


def test_the_button_makes_few_keys_of_a_dense_take_and_leaves_few_alone(extension, scene, smiling):
    scene.render.fps, scene.render.fps_base = 30, 1.0
    assert not bpy.ops.mimetic.reduce_keys.poll()
    extension("scene_out").bake(scene, smiling, "take")
    action = scene.mimetic.face.data.shape_keys.animation_data.action
    dense = sum(len(curve.keyframe_points) for curve in muscle_curves(extension, scene).values())
    assert bpy.ops.mimetic.reduce_keys(tolerance=TOLERANCE) == {"FINISHED"}
    curves = muscle_curves(extension, scene)
    few = [len(curve.keyframe_points) for curve in curves.values()]
    assert sum(few) <= 0.1 * dense
    assert worst(curves, smiling, 30) <= TOLERANCE + 1e-4
    assert bpy.ops.mimetic.reduce_keys(tolerance=0.3) == {"FINISHED"}
    assert [len(curve.keyframe_points) for curve in muscle_curves(extension, scene).values()] == few
    assert "few keys already" in result()["message"]
    assert scene.mimetic.face.data.shape_keys.animation_data.action == action


def test_a_tolerance_that_no_curve_has_is_refused_before_anything_changes(
    extension, scene, performance
):
    with pytest.raises(ValueError, match="tolerance"):
        extension("scene_out").bake(scene, performance, "take", tolerance=3.0)
    assert scene.mimetic.face is None


@pytest.mark.parametrize(("fps", "base"), RATES)
def test_keys_by_phases_play_the_same_and_each_event_is_dragged_alone(
    extension, scene, smiling, fps, base
):
    scene.render.fps, scene.render.fps_base = round(fps / base), round(fps / base) * base / fps
    bake = extension("scene_out").bake
    bake(scene, smiling, "take", tolerance=TOLERANCE, by_phases=True)
    curves = muscle_curves(extension, scene)
    assert worst(curves, smiling, fps / base) <= TOLERANCE + 1e-4
    scale = fps / base / smiling.fps
    curve = curves[smiling.muscles[0]]
    frames = np.array([point.co.x for point in curve.keyframe_points])
    first_event = ((frames - 1) / scale > 15) & ((frames - 1) / scale < 60)
    assert first_event.sum() >= 4  # the corners of these curves take more than six
    # The apex is dragged: nothing of the other event moves
    at = 1 + scale * np.arange(FRAMES)
    before = np.array([curve.evaluate(t) for t in at])
    key = max(
        (p for p, is_in in zip(curve.keyframe_points, first_event, strict=True) if is_in),
        key=lambda point: point.co.y,
    )
    key.co_ui = (key.co.x, key.co.y + 0.2)
    curve.update()
    change = np.array([curve.evaluate(t) for t in at]) - before
    assert np.abs(change).max() > 0.19
    assert np.abs(change[62:]).max() < 1e-6
