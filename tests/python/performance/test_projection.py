# SPDX-License-Identifier: GPL-3.0-or-later
"""A flat square before the camera: what the texture must show can be written down."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.performance.projection import colour_index, project_texture, reference_index
from mimetic.shared.picture import picture_coordinates
from sample_performance import make_performance

SIZE = 64


def square(behind: bool = False):
    """A 20 x 20 cm square, in quads of 2 cm, and half a second one 5 cm behind it if asked."""
    side = 11
    x, y = np.meshgrid(np.linspace(-0.1, 0.1, side), np.linspace(-0.1, 0.1, side))
    front = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).reshape(-1)
    faces = np.stack([corner, corner + 1, corner + side + 1, corner + side], axis=1)
    vertices = front
    if behind:
        vertices = np.vstack([front, front - [0, 0, 0.05]])
        faces = np.vstack([faces, faces + len(front)])
    modes = np.zeros((36, len(vertices), 3))
    pose = np.tile(np.diag([1.0, -1, -1, 1]), (1, 1, 1))
    pose[:, 2, 3] = 0.5
    performance = make_performance(
        1,
        neutral_vertices=vertices,
        faces=faces,
        muscle_modes=modes,
        articulator_modes=np.zeros((2, len(vertices), 3)),
        head_pose=pose,
    )
    uv = (vertices[:, :2] + 0.1) / 0.2
    return performance, uv[faces]


def ramps(performance):
    """An image whose red is the column and green the row: colours tell their own place."""
    width, height = performance.image_size
    image = np.zeros((height, width, 3), np.uint8)
    image[..., 0] = np.arange(width) * 255 // width
    image[..., 1] = (np.arange(height) * 255 // height)[:, None]
    image[..., 2] = 90
    return image


def test_every_texel_has_the_colour_of_its_own_pixel():
    performance, uv = square()
    weights = np.ones(len(performance.neutral_vertices))
    texture, colour = project_texture(performance, 0, ramps(performance), uv, weights, SIZE)
    centres = (np.arange(SIZE) + 0.5) / SIZE * 0.2 - 0.1
    x, y = np.meshgrid(centres, -centres)  # the texture's first row is on top
    columns = 400 * x / 0.5 + 159.5
    rows = 400 * -y / 0.5 + 119.5
    np.testing.assert_allclose(texture[..., 0], columns * 255 / 320, atol=2.5)
    np.testing.assert_allclose(texture[..., 1], rows * 255 / 240, atol=2.5)
    assert colour[2] == pytest.approx(90)


def test_what_is_hidden_takes_no_colours():
    performance, uv = square(behind=True)
    weights = np.zeros(len(performance.neutral_vertices))
    weights[len(weights) // 2 :] = 1
    with pytest.raises(InvalidInput, match="outside the picture"):
        project_texture(performance, 0, ramps(performance), uv, weights, SIZE)


def test_unwanted_parts_are_filled_from_their_surroundings():
    performance, uv = square()
    weights = (performance.neutral_vertices[:, 0] < 0.02).astype(float)
    image = ramps(performance)
    image[:, 200:] = (0, 255, 0)  # the unwanted side
    texture, _ = project_texture(performance, 0, image, uv, weights, SIZE)
    assert texture[..., 2].min() > 60  # the wanted side's blue goes on
    assert texture[:, -8:, 1].max() < 250


def test_coordinates_are_the_pictures_edges():
    corners = picture_coordinates([[-0.5, -0.5], [319.5, 239.5]], (320, 240))
    np.testing.assert_allclose(corners, [[0, 1], [1, 0]])
    performance, _ = square()
    pixels = performance.project(performance.surface_in_camera(0))
    middle = picture_coordinates(pixels, performance.image_size).mean(axis=0)
    np.testing.assert_allclose(middle, [0.5, 0.5], atol=1e-9)


def test_another_clips_picture_is_refused():
    performance, uv = square()
    weights = np.ones(len(performance.neutral_vertices))
    with pytest.raises(InvalidInput, match="another clip"):
        project_texture(performance, 0, np.zeros((10, 10, 3), np.uint8), uv, weights, SIZE)


def test_colours_come_from_a_frame_that_faces_the_camera_at_rest():
    performance = make_performance(12)
    performance.activations[:] = 0.5
    performance.activations[0] = 0
    assert reference_index(performance) == 0
    performance.quality[0] = 0.0
    performance.head_pose[0] = np.diag([-1.0, -1, 1, 1])  # seen from behind
    assert reference_index(performance) != 0


def test_colours_are_not_of_a_clips_first_second_where_another_frame_is_nearly_as_good():
    poses = np.tile(make_performance().head_pose[:1], (60, 1, 1))
    still = np.zeros((60, 36))
    shut = np.zeros((60, 2))
    quality = np.full(60, 0.95)
    quality[3] = 1.0
    performance = make_performance(
        num_frames=60,
        head_pose=poses,
        activations=still,
        articulator_values=shut,
        quality=quality,
    )
    assert reference_index(performance) == 3
    assert performance.frame[colour_index(performance)] == 24  # of 23.976 a second
    quality[10:] = 0.5
    performance.quality[:] = quality
    assert colour_index(performance) == 3
