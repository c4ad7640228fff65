# SPDX-License-Identifier: GPL-3.0-or-later
"""Where a head without landmarks is in its object, and where it faces there."""

import numpy as np
import pytest
from mimetic._core import from_rotation_vectors, world_from_moved_head
from mimetic.character.placement import to_object
from mimetic.template.face_template import load_template

QUARTER = 0.5 * np.pi


def about_x(angle: float) -> np.ndarray:
    return from_rotation_vectors(np.array([[angle, 0.0, 0.0]]))[0]


def made(unit: str, mesh_turn, world_turn, scale=(1.0, 1.0, 1.0)):
    """A head's mesh with a key (all for ""), turned in its object, and how the object stands."""
    template = load_template()
    modes = np.asarray(template.unit_modes, dtype=np.float64)
    wanted = [n for n, name in enumerate(template.unit_names) if name.startswith(unit)]
    moved = (modes[wanted] ** 2).sum(axis=(0, 2))
    points = 100 * to_object(template.vertices) @ mesh_turn.T
    faces = template.faces
    matrix = np.eye(4)
    matrix[:3, :3] = world_turn @ np.diag(np.array(scale) / 100)
    matrix[:3, 3] = [1.0, -2.0, 0.5]
    return (points, np.arange(0, faces.size, 4), faces.reshape(-1), moved), matrix


def places(mesh, matrix) -> np.ndarray:
    """3 x 3 and 3: of the character in the world."""
    world = world_from_moved_head(*mesh, matrix)
    return world[:3, :3], world[:3, 3]


@pytest.mark.parametrize("unit", ["", "jawOpen", "eyeBlink", "brow", "mouth"])
@pytest.mark.parametrize("up", ["z", "y"])
def test_a_head_whose_mesh_has_another_axis_up_is_found_alike(unit, up):
    mesh_turn = np.eye(3) if up == "z" else about_x(-QUARTER)
    mesh, matrix = made(unit, mesh_turn, mesh_turn.T)
    axes, _ = places(mesh, matrix)
    np.testing.assert_allclose(axes, np.eye(3), atol=1e-9)


def test_ears_are_behind_what_moves():
    template = load_template()
    mesh, matrix = made("", np.eye(3), np.eye(3))
    _, ears = places(mesh, matrix)
    tragus = to_object(template.vertices[template.landmark("tragus.L")][None])[0]
    off = ears - matrix[:3, 3] - tragus * [0, 1, 1]
    assert (np.abs(off) < [0.003, 0.02, 0.06]).all()


@pytest.mark.parametrize("angle", [-QUARTER, 0.4, QUARTER])
def test_a_head_that_lies_is_found(angle):
    mesh, matrix = made("", np.eye(3), about_x(angle))
    np.testing.assert_allclose(places(mesh, matrix)[0], about_x(angle), atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_mirrored_head_looks_as_it_is_seen_to(axis):
    scale = np.ones(3)
    scale[axis] = -1
    mesh, matrix = made("", np.eye(3), np.eye(3), scale)
    axes, _ = places(mesh, matrix)
    np.testing.assert_allclose(axes[:, 1:], np.diag(scale)[:, 1:], atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1)


def test_points_alone_stand_as_their_object():
    mesh = (np.zeros((1, 3)), [], [], np.zeros(1))
    np.testing.assert_allclose(places(mesh, np.eye(4))[0], np.eye(3), atol=1e-9)
