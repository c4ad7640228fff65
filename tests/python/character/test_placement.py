# SPDX-License-Identifier: GPL-3.0-or-later
"""Placement in a z-up scene, against rotation matrices and a pinhole written out."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.character.placement import WORLD_FROM_SCENE_CAMERA, head_motion, lens, to_object
from sample_performance import make_performance


def matrix_of(q):
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def turning(num_frames: int):
    """Three full turns about a slanted axis: every half-turn is where quaternions may flip."""
    axis = np.array([0.2, 0.9, 0.4]) / np.linalg.norm([0.2, 0.9, 0.4])
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    poses = np.tile(np.eye(4), (num_frames, 1, 1))
    for i, angle in enumerate(np.linspace(0, 6 * np.pi, num_frames)):
        poses[i, :3, :3] = (
            np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        ) @ np.diag([1.0, -1, -1])
    poses[:, :3, 3] = [0.01, -0.02, 0.6]
    return poses


@pytest.fixture
def performance():
    return make_performance(12, head_pose=turning(12))


def test_motion_puts_vertices_where_the_camera_saw_them(performance):
    motion = head_motion(performance)
    for i in range(performance.num_frames):
        local = to_object(performance.surface(i))
        world = local @ matrix_of(motion.quaternions[i]).T + motion.locations[i]
        x, y, z = performance.surface_in_camera(i).T
        np.testing.assert_allclose(world, np.column_stack([x, z, -y]), atol=1e-12)


def test_neighbouring_rotations_are_on_one_side():
    q = head_motion(make_performance(400, head_pose=turning(400))).quaternions
    assert np.einsum("ij,ij->i", q[1:], q[:-1]).min() > 0.99


def test_a_cameras_scale_does_not_count(performance):
    scaled = WORLD_FROM_SCENE_CAMERA @ np.diag([3.0, 3, 3, 1])
    np.testing.assert_allclose(
        head_motion(performance, scaled).locations, head_motion(performance).locations
    )


def test_a_flat_camera_is_refused(performance):
    with pytest.raises(InvalidInput, match="scale"):
        head_motion(performance, np.diag([1.0, 0, 1, 1]))


def test_pixels_that_are_not_square_are_refused():
    with pytest.raises(InvalidInput, match="square"):
        lens([[500, 0, 160], [0, 450, 120], [0, 0, 1]], (320, 240))


@pytest.mark.parametrize(
    ("picture", "aspect", "covered"),
    [
        ((320, 240), 1.0, (1, 1)),
        ((640, 240), 1.0, (0.5, 1)),
        ((320, 480), 1.0, (1, 0.5)),
        ((640, 240), 2.0, (1, 1)),
    ],
    ids=["as the footage", "wider", "taller", "pixels twice as high"],
)
def test_the_part_of_the_picture_that_footage_covers(picture, aspect, covered):
    lens_of = lens([[500, 0, 160], [0, 500, 120], [0, 0, 1]], (320, 240), picture, aspect)
    assert lens_of.covered == pytest.approx(covered)
