# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's loop: its dynamics are the equation's, and it reads a muscle and a turn from flow."""

from itertools import pairwise

import numpy as np
import pytest
from mimetic.score.sampling import sampled
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import find_face

from evaluation.baselines import paper_loop
from evaluation.baselines.paper_loop import Observer, ReducedFace, capture_by_loop

CAMERA = np.array([[300.0, 0, 79.5], [0, 300, 59.5], [0, 0, 1]])
STEP = 1 / 30


def plane_face():
    """A patch of skin 0.5 m away that one muscle pulls to the right by 6 mm, most in the middle."""
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.linspace(-0.06, 0.06, 25)] * 2))
    samples = np.column_stack([x, y, 0 * x])
    squared = np.array([(2 * np.pi * 30) ** 2])
    moved = np.zeros((len(x), 3, 1))
    moved[:, 0, 0] = np.exp(-(x**2 + y**2) / (2 * 0.03**2))
    loads = np.zeros((1, 39))
    loads[0, 11] = 0.006 * squared[0]
    normals = np.tile([0.0, 0, 1], (len(x), 1))
    return ReducedFace(
        squared, 19 + 0.01 * squared, loads, np.zeros((1, 4, 3)), samples, normals, moved
    )


def facing():
    pose = np.eye(4)
    pose[:3, :3] = np.diag((1, -1, -1))
    pose[2, 3] = 0.5
    return pose


def shown(activation, sideways=0.0):
    """A textured picture of the patch; the activation is of the muscle, sideways in metres."""
    x, y = np.meshgrid(np.arange(160.0), np.arange(120.0))
    pixels = np.stack([x, y], 2)
    at = pixels - CAMERA[:2, 2]
    shift = 0.006 * activation * np.exp(-((at / 300 * 0.5) ** 2).sum(2) / (2 * 0.03**2))
    pixels[..., 0] -= 600 * (shift + sideways)
    texture = np.random.default_rng(2).uniform(40, 220, (120, 160, 1))
    for axis in (0, 1):
        for _ in range(3):
            texture = (texture + np.roll(texture, 1, axis) + np.roll(texture, -1, axis)) / 3
    return np.round(sampled(texture, pixels)[..., 0]).astype(np.uint8)


def test_a_held_force_moves_the_skin_as_small_steps_of_the_equation_do():
    squared, damping = np.array([900.0, 40000.0]), np.array([20.0, 500.0])
    transition, held = paper_loop._discrete(squared, damping, STEP)
    place, rate, force = np.array([1.0, -0.5]), np.array([3.0, 2.0]), np.array([700.0, 900.0])
    result = transition @ np.concatenate([place, rate]) + held @ force
    for _ in range(20000):
        rate = rate + STEP / 20000 * (force - damping * rate - squared * place)
        place = place + STEP / 20000 * rate
    np.testing.assert_allclose(result, np.concatenate([place, rate]), rtol=2e-3, atol=1e-3)


def test_a_muscle_that_pulls_is_read_from_the_flow():
    observer = Observer(plane_face(), facing(), STEP)
    truth = np.concatenate([np.linspace(0, 0.8, 8), [0.8, 0.8]])
    for before, after in pairwise(truth):
        observer.advance(shown(before), shown(after), CAMERA)
    assert observer.control[11] == pytest.approx(0.8, abs=0.25)
    assert np.abs(np.delete(observer.control, 11)).max() < 1e-6
    assert 0 < observer.control_std[11] < 0.5


def test_a_head_that_slides_moves_the_pose_and_no_muscle():
    observer = Observer(plane_face(), facing(), STEP)
    for i in range(4):
        observer.advance(shown(0, 0.001 * i), shown(0, 0.001 * (i + 1)), CAMERA)
    assert observer.pose[0, 3] == pytest.approx(0.004, abs=0.001)
    assert observer.control[11] < 0.1


def test_a_clip_is_captured_until_the_user_stops(rendered_clip):
    fit = find_face(rendered_clip.footage, frame=4)
    summary = CaptureSummary()
    result = capture_by_loop(
        rendered_clip.footage,
        (2, 50),
        fit,
        lambda _, told: "frame 8 of" not in told,
        summary,
    )
    assert summary.stopped
    assert result.frame.tolist() == [2, 3, 4, 5, 6, 7]
    np.testing.assert_allclose(result.head_pose[2], fit.head_pose)
    np.testing.assert_allclose(result.surface(2), result.neutral_vertices, atol=1e-9)
    assert np.abs(result.surface(5) - result.neutral_vertices).max() > 1e-6
    assert result.activations_std[5].min() > 0
