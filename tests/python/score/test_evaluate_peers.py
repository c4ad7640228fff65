# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows points through a clip, ours and simple ways, does so as it says."""

import dataclasses

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.score import scores
from mimetic.score.peers import dis_tracks
from mimetic.score.prediction import follow

from evaluation.runs import flow
from evaluation.runs.vertex_flow import SeenVertices


def test_a_face_elsewhere_in_the_image_is_an_error(performance):
    with pytest.raises(InvalidInput, match="covers no point"):
        follow(performance, np.array([[2.0, 2.0]]))


def test_dis_flow_follows_a_sliding_picture():
    rng = np.random.default_rng(1)
    coarse = np.kron(rng.integers(40, 216, (24, 32)), np.ones((10, 10)))
    kernel = np.ones(7) / 7
    for axis in (0, 1):
        coarse = np.apply_along_axis(np.convolve, axis, coarse, kernel, "same")
    images = [
        np.repeat(np.roll(coarse, 2 * i, 1)[..., None], 3, 2).astype(np.uint8) for i in range(5)
    ]
    start = np.array([[100.0, 80.0], [200.0, 150.0]])
    for tracks in dis_tracks(images, start).values():
        np.testing.assert_allclose(tracks[4], start + np.array([8, 0]), atol=0.3)


def test_vertices_on_the_flow_follow_a_rigid_head(performance, truth):
    """Where the flow is a rigid motion, nothing moves in the head frame."""
    vertices = SeenVertices.under(performance, truth.tracks[0])
    poses = performance.head_pose
    tracks = scores.project(vertices.neutral[None], poses, performance.intrinsics)
    points = vertices.points(tracks)
    np.testing.assert_allclose(points - points[:1], 0, atol=2e-5)


def test_flow_that_knows_its_error_has_the_normalised_error_two():
    rng = np.random.default_rng(4)
    std = rng.uniform(0.05, 0.5, 20000)
    off = rng.normal(0, 1, (20000, 2)) * std[:, None]
    error = np.linalg.norm(off, axis=1)
    honest = flow.by_decile(flow.FlowErrors(std**2, error, (error / std) ** 2))
    for row in honest.values():
        assert row["normalised"] == pytest.approx(2, abs=0.25)
        assert row["typical"] == pytest.approx(2, abs=0.25)
        assert row["rms"] == pytest.approx(row["std"], rel=0.08)
    assert honest["tenth 1"]["std"] < 0.1 < honest["tenth 10"]["std"]


def test_flow_is_compared_with_the_true_motion_of_points(truth):
    """A picture that does not move, of points that do: the error is their motion."""
    noise = np.random.default_rng(6).integers(0, 255, tuple(truth.image_size[::-1]), np.uint8)
    moving = dataclasses.replace(truth, tracks=truth.tracks[:1] + np.arange(40)[:, None, None])
    pairs = list(flow.flow_errors(moving, [noise] * 3, "dis", 2))
    assert len(pairs) == 1
    np.testing.assert_allclose(pairs[0].error, 2 * np.sqrt(2), atol=0.2)
    assert (pairs[0].normalised > 0).all()
