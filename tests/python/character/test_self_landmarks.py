# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks that place themselves on heads of other makes."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.foreign_face import Polygons
from mimetic.character.foreign_mesh import REQUIRED
from mimetic.character.self_landmarks import _people, find_landmarks, find_on_object
from mimetic.locate.feature_networks import installed_networks
from mimetic.template.face_template import load_template

from evaluation.synthetic.characters import BLENDER, EYEBALL, GLTF, ODD, Recipe, Style, made


def errors(character, placed) -> np.ndarray:
    """Of the interpupillary distance, by landmark."""
    gaps = [placed.places[name] - character.truth[name] for name in REQUIRED]
    return np.sqrt((np.array(gaps) ** 2).sum(1)) / character.pupil_distance


@pytest.mark.parametrize(
    ("axes", "unit"), [(BLENDER, 1.0), (GLTF, 100.0), (ODD, 39.37)], ids=["z up", "y up", "lying"]
)
def test_they_find_their_places_whichever_way_a_head_looks(axes, unit):
    person = made(Recipe("person", 120, 0.3, 0.0, axes, unit), load_template())
    placed = find_landmarks(person.vertices, person.triangles)
    assert not placed.guess
    assert errors(person, placed).mean() < 0.015  # .025 by the networks alone
    assert errors(person, placed).max() < 0.04
    assert placed.doubtful == []


def test_they_find_their_places_on_a_face_without_its_head():
    """Its lashes are as wide as a sixth of it, and nothing around says where a face begins."""
    mask = made(Recipe("mask", 120, 0.3, 0.0, GLTF, 1.0, Style(is_mask=True)), load_template())
    placed = find_landmarks(mask.vertices, mask.triangles)
    assert errors(mask, placed).mean() < 0.015  # .08 as whole heads are looked at
    corners = np.char.startswith(REQUIRED, "eye")
    assert errors(mask, placed)[corners].max() < 0.035  # .16


def test_a_head_without_eyeballs_is_looked_at_beside_one_without():
    person = made(Recipe("person", 100, 0.4, 0.0, GLTF), load_template())
    has_ball = (person.kind[person.triangles] == EYEBALL).any(axis=1)
    placed = find_landmarks(person.vertices, np.ascontiguousarray(person.triangles[~has_ball]))
    corners = np.char.startswith(REQUIRED, "eye")
    assert errors(person, placed)[corners].mean() < 0.012  # .025 by the networks alone


def test_they_lie_on_the_mesh():
    person = made(Recipe("person", 121, 0.3, 0.0, GLTF), load_template())
    placed = find_landmarks(person.vertices, person.triangles)
    corners = person.vertices[person.triangles]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normals = np.cross(first, second)
    normals /= np.maximum(np.sqrt((normals**2).sum(1)), 1e-15)[:, None]
    for place in placed.places.values():
        near = np.sqrt(((corners.mean(1) - place) ** 2).sum(1)) < 0.008
        assert np.abs(((place - corners[near, 0]) * normals[near]).sum(1)).min() < 2e-5


def test_what_is_no_face_gets_a_guess_that_says_so():
    around, up = np.meshgrid(np.arange(24), np.arange(13), indexing="ij")
    angle, height = around * np.pi / 12, up * np.pi / 12
    ball = np.stack(
        [np.sin(height) * np.cos(angle), np.sin(height) * np.sin(angle), np.cos(height)], -1
    ).reshape(-1, 3)
    starts = [
        (a * 13 + u, a * 13 + u + 1, (a + 1) % 24 * 13 + u + 1, (a + 1) % 24 * 13 + u)
        for a in range(24)
        for u in range(12)
    ]
    corners = np.array(starts).ravel()
    polygons = Polygons(np.arange(0, len(corners), 4), corners)
    placed = find_on_object(0.1 * ball, polygons, np.eye(4))
    assert "no face" in placed.guess
    assert placed.doubtful == list(REQUIRED)


def test_they_stop_when_told():
    person = made(Recipe("person", 120, 0.3, 0.0, GLTF), load_template())
    calls = []

    def stops(fraction, text):
        calls.append((fraction, text))
        return len(calls) < 3

    with pytest.raises(KeyboardInterrupt):
        find_landmarks(person.vertices, person.triangles, stops)
    assert len(calls) == 3


def test_without_networks_they_are_a_guess(monkeypatch):
    from mimetic.character import self_landmarks

    person = made(Recipe("person", 120, 0.3, 0.0, BLENDER), load_template())
    monkeypatch.setattr(self_landmarks, "_finder", lambda: None)
    placed = find_landmarks(person.vertices, person.triangles)
    assert "networks" in placed.guess
    assert errors(person, placed).max() < 1


@pytest.mark.parametrize("vertex", [-1, 10**9])
def test_a_landmark_that_is_no_vertex_of_the_template_is_refused(vertex):
    template = load_template()
    triangles, _ = _core.cut_faces(template.vertices, template.faces.astype(np.int64))
    networks = installed_networks()
    with pytest.raises(InvalidInput, match=f"landmark chin is vertex {vertex}"):
        _core.LandmarkFinder(
            template.vertices, triangles, ["chin"], [vertex], _people(template), networks
        )
