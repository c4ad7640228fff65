# SPDX-License-Identifier: GPL-3.0-or-later
"""A model that overturns is put right; what has no order changes little."""

import numpy as np
from mimetic._core import PlacedView, from_rotation_vectors, place_poses, rotation_vectors


def poses_at(vectors):
    poses = np.tile(np.diag([1.0, -1, -1, 1]), (len(vectors), 1, 1))
    poses[:, :3, :3] = from_rotation_vectors(np.asarray(vectors)) @ poses[:, :3, :3]
    poses[:, 2, 3] = 0.6
    return poses


def views_at(on_model, on_skin):
    pairs = zip(poses_at(on_model), poses_at(on_skin), strict=True)
    return [PlacedView(on_model, on_skin) for on_model, on_skin in pairs]


def turns_of(poses):
    return rotation_vectors(poses[:, :3, :3] @ poses_at([[0, 0, 0]])[0, :3, :3].T)


def yaws(degrees):
    return np.radians(degrees)[:, None] * np.array([0, 1.0, 0])


def test_a_model_that_overturns_is_put_right():
    true = np.array([0.0, 10, 20, 30, 40, 50, -10, -20, -30])
    views = views_at(yaws(1.2 * true), yaws(true))
    between = np.array([0.0, 5, 25, 45, -25])
    placed = np.degrees(turns_of(place_poses(poses_at(yaws(1.2 * between)), views)))
    np.testing.assert_allclose(placed[:, 1], between, atol=0.6)
    np.testing.assert_allclose(placed[:, [0, 2]], 0, atol=0.1)
    np.testing.assert_allclose(placed[0], 0, atol=0.05)


def test_expressions_turn_the_head_less_than_they_would():
    at = yaws(np.array([0.0, 3, -4, 6, -2, 5]))
    nods = np.radians([0.0, 6, -5, 7, 6, -6])[:, None] * np.array([1.0, 0, 0])
    placed = turns_of(place_poses(poses_at(at), views_at(at, at + nods)))
    assert np.abs(placed - at).mean() < 0.25 * np.abs(nods).mean()


def test_the_head_moves_with_its_textures():
    views = views_at(yaws(np.array([0.0, 20, 40])), yaws(np.array([0.0, 20, 40])))
    nearer = np.diag([1.0, 1, 1, 1])
    nearer[2, 3] = 0.01
    views[1:] = [PlacedView(view.on_model, nearer @ view.on_skin) for view in views[1:]]
    placed = place_poses(poses_at(yaws(np.array([30.0]))), views)
    assert 0.007 < placed[0, 2, 3] - 0.6 < 0.012
