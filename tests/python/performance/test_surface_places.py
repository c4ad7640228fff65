# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic._core import cast_rays
from mimetic.commands.points import track_points
from mimetic.performance.places import RefinedSurface, places_under
from mimetic.score.prediction import follow
from mimetic.template.face_template import load_template
from sample_performance import make_performance


def sheets(*places):
    """A turning head of flat sheets that face the camera: (left, right, bottom, top, z), metres."""
    vertices, faces = [], []
    for left, right, bottom, top, z in places:
        x, y = np.meshgrid(np.linspace(left, right, 7), np.linspace(bottom, top, 7))
        corner = len(vertices) * 49 + (np.arange(6)[:, None] * 7 + np.arange(6)).reshape(-1)
        faces.append(np.stack([corner, corner + 1, corner + 8, corner + 7], axis=1))
        vertices.append(np.stack([x, y, np.full_like(x, z)], axis=-1).reshape(-1, 3))
    vertices = np.concatenate(vertices)
    still = np.zeros((12, 36)), np.zeros((12, 2))
    return make_performance(
        neutral_vertices=vertices,
        faces=np.concatenate(faces),
        muscle_modes=np.zeros((36, len(vertices), 3)),
        articulator_modes=np.zeros((2, len(vertices), 3)),
        activations=still[0],
        articulator_values=still[1],
    )


def test_on_skin_that_faces_the_camera_the_ray_decides():
    performance = make_performance()
    pixels = performance.image_size / 2 + np.random.default_rng(5).uniform(-25, 25, (60, 2))
    surface = RefinedSurface(performance)
    request = cast_rays(surface.camera, surface.in_camera(0), surface.triangles, pixels)
    under = places_under(surface, pixels)
    assert under.on_face.all() and (under.offset == 0).all()
    np.testing.assert_array_equal(under.triangle, request[0])
    np.testing.assert_allclose(under.weights, request[1])


def test_a_slit_shows_its_rim_and_not_what_lies_behind():
    # Two lips 2 mm apart, the throat 90 mm behind them
    performance = sheets(
        (-0.05, 0.05, 0.001, 0.05, 0.08),
        (-0.05, 0.05, -0.05, -0.001, 0.08),
        (-0.06, 0.06, -0.06, 0.06, -0.01),
    )
    in_slit, on_lip = performance.project(
        np.array([[0.0, 0, 0.08, 1], [0, 0.004, 0.08, 1]]) @ performance.head_pose[0][:3].T
    )
    result = track_points(performance, np.array([in_slit, on_lip]))
    assert result.on_face.all()
    np.testing.assert_allclose(result.tracks[0], [in_slit, on_lip], atol=1e-9)
    # The head turns by 17 degrees: the throat would go 12 pixels another way
    moved = result.tracks - result.tracks[:1]
    assert np.abs(moved[:, 0] - moved[:, 1]).max() < 0.5


def test_a_wide_gap_shows_what_lies_behind():
    performance = sheets(
        (-0.05, 0.05, 0.015, 0.05, 0.08),
        (-0.06, 0.06, -0.06, 0.06, -0.01),
    )
    at = np.array([[0.0, 0.0, -0.01, 1]]) @ performance.head_pose[0][:3].T
    result = track_points(performance, performance.project(at))
    expected = [
        performance.project((pose[:3] @ [0, 0, -0.01, 1])[None]) for pose in performance.head_pose
    ]
    np.testing.assert_allclose(result.tracks, expected, atol=1e-6)


def test_a_pixel_beside_the_face_is_off_it_and_still_followed_for_scores():
    performance = sheets((-0.05, 0.05, -0.05, 0.05, 0.08))
    edge = performance.project((performance.head_pose[0][:3] @ [0.05, 0, 0.08, 1])[None])[0]
    beside = edge + np.array([1.5, 0])
    assert not track_points(performance, beside[None]).on_face.any()
    followed = follow(performance, np.array([edge - np.array([0.5, 0]), beside]))
    assert followed.on_face.tolist() == [True, False]
    moved = followed.tracks - followed.tracks[:1]
    assert np.linalg.norm(moved, axis=2).max() == pytest.approx(10, abs=5)
    np.testing.assert_allclose(moved[:, 1], moved[:, 0], atol=0.5)


def test_lashes_do_not_stand_for_the_skin_that_shows_between_them():
    template = load_template()
    count = len(template.vertices)
    head = make_performance(
        neutral_vertices=template.vertices,
        faces=template.faces,
        muscle_modes=np.zeros((36, count, 3)),
        articulator_modes=np.zeros((2, count, 3)),
    )
    lashes = template.vertices[template.part_vertices("lashes.L", "lashes.R")]
    pose = head.head_pose[0]
    pixels = head.project(lashes @ pose[:3, :3].T + pose[:3, 3])
    surface = RefinedSurface(head)
    under = places_under(surface, pixels)
    corners = surface.in_camera(0)[surface.triangles[under.triangle]]
    result = np.einsum("kc,kcx->kx", under.weights, corners)
    nearer = result[:, 2] - (lashes @ pose[2, :3] + pose[2, 3])
    assert under.on_face.all()
    assert nearer.min() > -0.004  # roots lie below the skin
    assert nearer.max() > 0.004  # tips do not


def tube(radius):
    """A turning head that is an upright tube, metres."""
    angle, height = np.meshgrid(np.radians(np.linspace(-120, 120, 33)), np.linspace(-0.1, 0.1, 9))
    vertices = np.stack([radius * np.sin(angle), height, radius * np.cos(angle)], -1).reshape(-1, 3)
    corner = (np.arange(8)[:, None] * 33 + np.arange(32)).reshape(-1)
    return make_performance(
        neutral_vertices=vertices,
        faces=np.stack([corner, corner + 1, corner + 34, corner + 33], axis=1),
        muscle_modes=np.zeros((36, len(vertices), 3)),
        articulator_modes=np.zeros((2, len(vertices), 3)),
    )


@pytest.mark.parametrize(("fitted_radius", "most"), [(0.068, 0.6), (0.069, 0.4)])
def test_points_beside_a_head_fitted_too_narrow_turn_with_its_outline(fitted_radius, most):
    # The nearest skin that faces the camera would leave .67 and .44 pixels.
    true, fitted = tube(0.07), tube(fitted_radius)
    angle = np.radians(np.linspace(50, 78, 40))
    points = 0.07 * np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    tracks = np.array(
        [true.project(points @ pose[:3, :3].T + pose[:3, 3]) for pose in true.head_pose]
    )
    followed = follow(fitted, tracks[0])
    assert not followed.on_face.all()
    left = np.linalg.norm(followed.tracks - tracks, axis=2)
    assert np.sqrt((left**2).mean()) < most
