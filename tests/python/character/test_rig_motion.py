# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns in the forms that curves hold, and their way onto bones and objects."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic._core import euler_angles, from_rotation_vectors, quaternions, rotation_vectors
from mimetic.character.placement import world_from_object
from mimetic.character.rig_motion import (
    Bone,
    Motion,
    axes_of,
    bone_channels,
    carried_channels,
    facing,
    followed,
    motion,
    placed_channels,
    rotation_channels,
)
from sample_performance import make_performance


def about(axis: str, angles):
    vectors = np.zeros((len(angles), 3))
    vectors[:, "XYZ".index(axis)] = angles
    return from_rotation_vectors(vectors)


def some_rotations(num=50, size=2.5):
    """A smooth way through rotations, past a half turn."""
    t = np.linspace(0, 1, num)[:, None]
    return from_rotation_vectors(size * np.hstack([np.sin(3 * t), 1.3 * t, np.cos(4 * t) - 1]))


@pytest.mark.parametrize("order", ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"])
def test_euler_angles_turn_in_their_order_without_jumps(order):
    rotations = some_rotations(size=0.9)
    angles = euler_angles(rotations, order, np.zeros(3))
    first, second, third = (about(axis, angles[:, "XYZ".index(axis)]) for axis in order)
    np.testing.assert_allclose(third @ second @ first, rotations, atol=1e-12)
    assert np.abs(np.diff(angles, axis=0)).max() < 0.5


def test_vectors_and_quaternions_go_on_past_half_a_turn():
    vectors = np.outer(np.linspace(0, 5, 60), [0.6, 0, 0.8])
    np.testing.assert_allclose(
        rotation_vectors(from_rotation_vectors(vectors)), vectors, atol=1e-12
    )
    result = quaternions(from_rotation_vectors(vectors))
    assert (np.einsum("ij,ij->i", result[1:], result[:-1]) > 0.9).all()


@pytest.mark.parametrize("mode", ["QUATERNION", "AXIS_ANGLE", "XZY"])
def test_channels_have_no_jumps_through_rest(mode):
    turns = about("Z", np.linspace(-0.4, 0.4, 41))  # through 0, where an axis has no meaning
    _, values = rotation_channels(turns, mode)
    assert np.abs(np.diff(values, axis=0)).max() < 0.05


def test_relative_motion_is_none_in_its_rest_frame():
    performance = make_performance()
    moved = motion(performance, rest_frame=4)
    np.testing.assert_allclose(moved.rotations[3], np.eye(3), atol=1e-12)
    np.testing.assert_allclose(moved.shifts[3], 0, atol=1e-12)
    absolute = motion(performance, is_absolute=True, rest_frame=4)
    poses = world_from_object(performance)
    np.testing.assert_allclose(absolute.rotations, poses[:, :3, :3], atol=1e-12)
    with pytest.raises(InvalidInput, match="frame 99"):
        motion(performance, rest_frame=99)


def test_a_pivot_that_the_head_turns_about_stays():
    """A head that turns about its neck shifts midway between its ears, but not the neck."""
    performance = make_performance()
    neck = np.array([0.0, 0.02, -0.08])
    pose = performance.head_pose
    in_head = np.array([neck[0], neck[2], -neck[1]])
    pose[:, :3, 3] += pose[0, :3, :3] @ in_head - pose[:, :3, :3] @ in_head
    moved = motion(performance, rest_frame=1, pivot=neck)
    np.testing.assert_allclose(moved.shifts, 0, atol=1e-12)
    assert np.abs(motion(performance, rest_frame=1).shifts).max() > 0.005


@pytest.mark.parametrize("followed_share", [0.0, 0.3, 1.0])
def test_neck_and_head_together_turn_as_filmed(followed_share):
    turns = some_rotations(size=0.5)
    rest = some_rotations()
    head, neck = Bone(rest[10], "QUATERNION"), Bone(rest[30], "QUATERNION")
    own, of_neck = bone_channels(
        Motion(turns, np.zeros((len(turns), 3))), head, neck, 0.35, followed_share
    )
    neck_turns = neck.rest @ matrices(of_neck.rotations) @ neck.rest.T
    carried = from_rotation_vectors(followed_share * rotation_vectors(neck_turns))
    np.testing.assert_allclose(
        carried @ head.rest @ matrices(own.rotations) @ head.rest.T, turns, atol=1e-9
    )
    with pytest.raises(InvalidInput, match="neck share"):
        bone_channels(Motion(turns, np.zeros((len(turns), 3))), head, neck, 1.5)


def matrices(transforms):
    """N x 3 x 3 of N x 4 quaternions (w x y z)."""
    sines = np.linalg.norm(transforms[:, 1:], axis=1, keepdims=True)
    angles = 2 * np.arctan2(sines, transforms[:, :1])
    return from_rotation_vectors(angles * transforms[:, 1:] / np.maximum(sines, 1e-12))


@pytest.mark.parametrize(("direction", "left"), [("-Y", "+X"), ("+X", "+Y"), ("+Y", "-X")])
def test_a_character_that_faces_elsewhere_turns_to_its_own_left(direction, left):
    axes = facing(direction)
    look = np.array([0.0, -1, 0])
    to_left = about("Z", np.array([0.1]))[0] @ look - look  # from -y towards +x
    sign, axis = (1 if left[0] == "+" else -1), "XYZ".index(left[1])
    assert sign * (axes @ to_left)[axis] > 0.09


def test_the_part_that_follows_is_found():
    before = some_rotations()[7]
    after = about("X", np.array([0.2]))[0] @ before
    assert followed(before, after, 0.5) == pytest.approx(0.4)
    assert followed(before, before, 0.5) == pytest.approx(0)


@pytest.mark.parametrize("flat", [np.diag([1.0, 0, 1, 1]), np.diag([0.0, 0, 0, 1])])
def test_a_flat_object_is_refused(flat):
    with pytest.raises(InvalidInput, match="scale"):
        axes_of(flat)


@pytest.mark.parametrize("direction", ["-Y", "+X"])
@pytest.mark.parametrize("axis", range(3))
def test_a_mirrored_objects_face_looks_as_it_is_seen_to(axis, direction):
    turn = some_rotations()[20]
    signs = np.ones(3)
    signs[axis] = -1
    world = np.eye(4)
    world[:3, :3] = turn @ np.diag(0.01 * signs)
    axes = axes_of(world, direction)
    plain = turn @ np.diag(signs) @ facing(direction)
    np.testing.assert_allclose(axes[:, 1:], plain[:, 1:], atol=1e-12)  # what is back, and up
    assert np.linalg.det(axes) == pytest.approx(1)


def mirrored_parent(axis) -> np.ndarray:
    """4 x 4, of an empty that is turned, three times as large and mirrored along an axis."""
    signs = np.ones(3)
    signs[axis] = -1
    parent = np.eye(4)
    parent[:3, :3] = some_rotations()[20] @ np.diag(3 * signs)
    parent[:3, 3] = [1, 2, 3]
    return parent


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("direction", ["-Y", "+X"])
def test_under_a_mirrored_parent_a_head_is_upright_before_the_camera(axis, direction):
    performance, parent = make_performance(), mirrored_parent(axis)
    channels = placed_channels(performance, parent, "QUATERNION", np.eye(4), direction)
    poses = world_from_object(performance, np.eye(4))
    world = parent[:3, :3] @ matrices(channels.rotations) @ facing(direction) / 3
    np.testing.assert_allclose(world[:, :, 1:], poses[:, :3, 1:3], atol=1e-12)  # back, and up
    places = channels.locations @ parent[:3, :3].T + parent[:3, 3]
    np.testing.assert_allclose(places, poses[:, :3, 3], atol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_under_a_mirrored_parent_an_object_turns_as_the_head_does(axis):
    moved, parent = motion(make_performance(), rest_frame=1), mirrored_parent(axis)
    rotation = some_rotations()[30]
    axes = axes_of(parent)
    channels = carried_channels(moved, np.zeros(3), rotation, parent, axes, "QUATERNION")
    actual = parent[:3, :3] @ matrices(channels.rotations)
    turns = axes @ moved.rotations @ axes.T
    np.testing.assert_allclose(actual, turns @ parent[:3, :3] @ rotation, atol=1e-12)


def test_a_head_is_found_in_an_object_by_its_landmarks():
    """Vertices and places alike, whatever unit, axes and origin the object has."""
    from mimetic.character.bound_head import object_from_character
    from mimetic.character.foreign_mesh import REQUIRED
    from mimetic.character.placement import to_object
    from mimetic.template.face_template import load_template

    template = load_template()
    turn = from_rotation_vectors(np.array([[0.4, -1.2, 2.0]]))[0]
    shift = np.array([3.0, -40.0, 7.0])
    points = 100 * to_object(template.vertices) @ turn.T + shift
    metres_from_object = np.diag([0.01, 0.01, 0.01, 1])
    metres_from_object[:3, 3] = [1, 2, 3]
    vertices = {name: template.landmark(name) for name in REQUIRED}
    places = {name: 0.01 * points[vertex] + [1, 2, 3] for name, vertex in vertices.items()}
    for marks in (vertices, places):
        matrix = object_from_character(points, marks, metres_from_object)
        np.testing.assert_allclose(matrix[:3, :3], 100 * turn, atol=1e-4)
        np.testing.assert_allclose(matrix[:3, 3], shift, atol=1e-4)
