# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth from frames in which the head is turned otherwise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic._core import cast_rays, from_rotation_vectors
from mimetic.fit.depth_bumps import bump_places
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import face_model
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.fitting import landmark_places, refit
from mimetic.media.cuts import of_one_scene
from mimetic.skin.mesh import SkinMesh
from mimetic.solve.relief import find_relief
from mimetic.solve.tracking import depth_std
from mimetic.template.face_template import load_template

from evaluation.runs.projection import project_points

TURNS = np.radians([(0, 15, 0), (0, -14, 0), (9, 6, 0), (-8, -4, 3), (4, 10, 0)])
STILL = np.zeros((3, 3))
NOISE_PX = 0.3
FRONTAL = np.array([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.6], [0, 0, 0, 1]])
INTRINSICS = np.array([[700, 0, 319.5], [0, 700, 239.5], [0, 0, 1.0]])


@pytest.fixture(scope="module")
def fit() -> FaceFit:
    return FaceFit(1, (640, 480), INTRINSICS, FRONTAL, identity={})


def pixels_on_face(count: int) -> np.ndarray:
    """Cheeks, nose and forehead: holes of eyes and mouth are no surface."""
    x, y = np.meshgrid(np.linspace(-1, 1, count), np.linspace(-1, 1, count))
    inside = x**2 + y**2 <= 1
    pixels = np.column_stack([320 + 55 * x[inside], 240 + 70 * y[inside]])
    template = load_template()
    holes = np.flatnonzero(template.in_region("eyelid", "eye_socket", "mouth_cavity"))
    in_picture = project_points(template.vertices[holes], FRONTAL, INTRINSICS)[0]
    away = np.linalg.norm(pixels[:, None] - in_picture, axis=2).min(axis=1)
    return pixels[away > 6]


def surface_of(fit: FaceFit, pixels) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What the fitted frame shows at pixels: refined vertices, weights, places (head frame)."""
    template = load_template()
    mesh = SkinMesh(template, np.ascontiguousarray(fit.neutral_vertices(template)))
    pose = fit.head_pose
    in_camera = mesh.vertices @ pose[:3, :3].T + pose[:3, 3]
    triangles = np.ascontiguousarray(mesh.triangles, dtype=np.int32)
    triangle, weights = cast_rays(fit.camera, in_camera, triangles, pixels)
    assert (triangle >= 0).all()
    corners = mesh.triangles[triangle]
    return corners, weights, np.einsum("kc,kcx->kx", weights, mesh.vertices[corners])


def sightings_of(fit: FaceFit, person: FaceFit, turns) -> list[_core.Sighting]:
    """A person who shows nothing but turns, seen where the fit believes the skin to be."""
    pixels = pixels_on_face(31)
    corners, weights, _ = surface_of(fit, pixels)
    _, _, places = surface_of(person, pixels)
    rng = np.random.default_rng(3)
    sightings = []
    for number, turn in enumerate(turns):
        pose = fit.head_pose.copy()
        pose[:3, :3] = pose[:3, :3] @ from_rotation_vectors(turn[None])[0]
        shown = project_points(places, pose, fit.intrinsics)[0]
        shown += rng.normal(0, NOISE_PX, shown.shape)
        information = np.tile(np.eye(2) / NOISE_PX**2, (len(shown), 1, 1))
        values = np.zeros(1)
        sightings.append(
            _core.Sighting(number + 2, pose, values, corners, weights, shown, information)
        )
    return sightings


def with_relief_from(fit: FaceFit, seen: list[_core.Sighting]) -> FaceFit:
    template = load_template()
    idle = np.zeros((1, template.num_skin_vertices, 3))
    return find_relief(fit, template, seen, idle, np.ones(1))


def test_turned_frames_tell_how_deep_the_face_is(fit):
    shape = face_shape(load_template()).components
    nose = load_template().landmark("nose_tip")
    deep = shape[:, nose, 2]
    person = replace(fit, relief=(1.5 * deep / np.linalg.norm(deep)).tolist())
    fitted = with_relief_from(fit, sightings_of(fit, person, TURNS))
    pixels = pixels_on_face(15)
    true, before, after = (surface_of(one, pixels)[2][:, 2] for one in (person, fit, fitted))
    # All of it nearer or further is a pose, and the pose is free.
    left, error = np.std(after - true), np.std(before - true)
    assert error > 0.5e-3
    assert left < 0.5 * error
    landmarks = np.asarray(load_template().landmark_vertices)
    shown = [
        project_points(one.neutral_vertices(load_template())[landmarks], FRONTAL, INTRINSICS)[0]
        for one in (fit, fitted)
    ]
    assert np.abs(shown[1] - shown[0]).max() < 1.5  # pixels; a pupil distance is 72


def test_a_head_that_does_not_turn_keeps_its_shape(fit):
    same = with_relief_from(fit, sightings_of(fit, fit, STILL))
    assert np.linalg.norm(same.relief) < 0.3
    assert np.abs(same.depth).max() < 0.5e-3


def test_turned_frames_tell_a_depth_that_no_proportions_have(fit):
    """A face whose cheek is deeper by a bump alone, and further by what is found so far."""
    template = load_template()
    places = template.vertices[bump_places(template)]
    cheek = np.linalg.norm(places - template.vertices[template.landmark("nose_tip")], axis=1)
    bump = np.exp(-0.5 * ((cheek - 0.05) / 0.015) ** 2)[:, None] * [0.0, 0.0, -0.005]
    person = replace(fit, depth=bump.tolist())
    fitted = with_relief_from(fit, sightings_of(fit, person, TURNS))
    pixels = pixels_on_face(15)
    true, before, after = (surface_of(one, pixels)[2][:, 2] for one in (person, fit, fitted))
    assert np.std(after - true) < 0.7 * np.std(before - true)
    again = with_relief_from(fitted, sightings_of(fitted, person, TURNS))
    further = surface_of(again, pixels)[2][:, 2]
    assert np.std(further - true) < 1.1 * np.std(after - true)


def test_the_same_view_again_tells_nothing_more(fit):
    person = replace(
        fit, relief=np.linspace(-0.3, 0.3, len(face_shape(load_template()).components)).tolist()
    )
    sightings = sightings_of(fit, person, TURNS)
    once, often = (with_relief_from(fit, sightings * count) for count in (1, 5))
    np.testing.assert_allclose(often.relief, once.relief, atol=1e-3)
    np.testing.assert_allclose(often.depth, once.depth, atol=1e-5)


def test_depth_is_known_where_turned_frames_show_it(fit):
    """And what is known of it there is what a movement aside is doubted by."""
    template = load_template()
    once, twice = (
        with_relief_from(fit, sightings_of(fit, fit, turns)) for turns in (0.3 * TURNS, TURNS)
    )
    assert len(twice.depth_std) == len(bump_places(template))
    assert min(twice.depth_std) < 0.8 * min(once.depth_std)
    best_known = bump_places(template)[int(np.argmin(twice.depth_std))]
    names = ["jaw_open", "jaw_side"]
    modes = np.zeros((2, template.num_skin_vertices, 3))
    modes[1, best_known, 0] = 0.01
    near, far = (depth_std(names, modes, one.neutral_depth_std(template)) for one in (twice, once))
    assert 0 < near[1] < far[1] < depth_std(names, modes)[1]
    assert near[0] == 0


def test_too_few_frames_tell_nothing(fit):
    assert with_relief_from(fit, sightings_of(fit, fit, TURNS[:2])) is fit


def test_following_ends_with_the_scene():
    first, other = np.random.default_rng(0).integers(0, 256, (2, 64, 64, 3), np.uint8)
    images = [(2, first), (3, first), (4, other), (5, first)]
    assert [frame for frame, _ in of_one_scene(first, iter(images))] == [2, 3]


def test_pins_hold_the_head_with_its_relief(fit):
    """Whatever relief does to a landmark in the picture, its pin has the last word."""
    template = load_template()
    rng = np.random.default_rng(5)
    relief = rng.normal(0, 0.3, len(face_shape(template).components)).tolist()
    known = _core.project_features(
        face_model(template),
        _core.FaceEstimate([FRONTAL], 700.0, np.zeros(len(relief))),
        fit.camera,
    )
    measured = _core.FaceFeatures(
        [_core.Feature(f.name, f.position, 2.0) for f in known.features], [], np.zeros(4), 1.0
    )
    in_view = replace(fit, relief=relief, views=[FittedView(1, FRONTAL, measured)])
    x, y = landmark_places(in_view)["mouth_corner.L"]
    pinned = refit(in_view, {"mouth_corner.L": (x + 3, y - 2)})
    corner = pinned.neutral_vertices(template)[[template.landmark("mouth_corner.L")]]
    shown = project_points(corner, pinned.head_pose, pinned.intrinsics)[0][0]
    np.testing.assert_allclose(shown, (x + 3, y - 2), atol=0.3)


def test_relief_of_another_head_is_refused(fit, tmp_path):
    with pytest.raises(InvalidInput, match="relief coefficients"):
        replace(fit, relief=[0.1, 0.2]).neutral_vertices(load_template())
    kept = replace(fit, relief=[0.5] * len(face_shape(load_template()).components))
    kept.depth = [[0.001, 0.0, -0.002]] * len(bump_places(load_template()))
    kept.depth_std = [0.002] * len(kept.depth)
    kept.save(tmp_path / "fit.json")
    loaded = FaceFit.load(tmp_path / "fit.json")
    assert loaded.relief == kept.relief
    assert loaded.depth == kept.depth
    assert loaded.depth_std == kept.depth_std
    np.testing.assert_allclose(loaded.neutral_depth_std(load_template()), 0.002)
    with pytest.raises(InvalidInput, match="depth coefficients"):
        replace(fit, depth=[[0.1, 0.2, 0.3]]).neutral_vertices(load_template())
    with pytest.raises(InvalidInput, match="depth_std"):
        replace(fit, depth_std=[0.001]).neutral_depth_std(load_template())
    with pytest.raises(InvalidInput, match="depth_std must be 0 or more"):
        replace(fit, depth_std=[-0.001])
