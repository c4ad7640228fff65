# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles, materials and footprints in proportion to the person."""

import numpy as np
import pytest
from mimetic.muscles import anatomy
from mimetic.skin.mesh import SkinMesh, find_place
from mimetic.template.face_template import load_template

SYMMETRY = np.array([-1.0, 1.0, 1.0])
# Size of the whole head, and its shape: the identity space has adults only, so the child is one of
# 0.8 times the size with a child's proportions (Farkas 1994: large eyes, short lower face).
PEOPLE = {
    "large man": (1.1, {"sex_male": 1.2, "muscle": 0.8, "head_rectangular": 0.6}),
    "small woman": (0.93, {"sex_male": -1.2, "head_oval": 0.7, "mouth_scale_horiz": -0.5}),
    "child": (
        0.8,
        {
            "head_round": 0.7,
            "cheek_volume": 0.6,
            "chin_height": -0.6,
            "eye_scale": 0.6,
            "nose_scale_vert": -0.6,
        },
    ),
}


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def usual(template):
    return anatomy.attach(template.vertices, template)


@pytest.fixture(scope="module", params=PEOPLE)
def person(request, template):
    size, shape = PEOPLE[request.param]
    mesh = SkinMesh(template, size * template.neutral(shape))
    return mesh, anatomy.attach(mesh.neutral, template)


def spread(vertices, mode):
    """Root mean square distance of a motion from its middle, metres."""
    weight = (mode**2).sum(axis=1)
    middle = weight @ vertices / weight.sum()
    return np.sqrt(weight @ ((vertices - middle) ** 2).sum(axis=1) / weight.sum())


def test_the_template_has_its_own_size(template):
    assert (SkinMesh(template, template.vertices).local_scale == 1).all()


def test_a_larger_face_of_one_shape_has_every_mode_in_proportion(template, usual):
    mesh = SkinMesh(template, 1.25 * template.vertices)
    np.testing.assert_allclose(mesh.local_scale, 1.25, rtol=1e-12)
    large = anatomy.attach(mesh.neutral, template)
    for name, own, other in zip(
        usual.muscle_names, large.muscle_modes, usual.muscle_modes, strict=True
    ):
        assert np.linalg.norm(own - 1.25 * other) < 1e-3 * np.linalg.norm(own), name
    for name, own, other in zip(
        usual.articulator_names, large.articulator_modes, usual.articulator_modes, strict=True
    ):
        assert np.linalg.norm(own - 1.25 * other) < 1e-3 * np.linalg.norm(own), name
    # Force goes with the cross-section of a muscle, a sphincter's tension with its thickness
    power = np.where([name.startswith("orbicularis_oris") for name in usual.muscle_names], 1, 2)
    ratio = large.muscle_strengths / usual.muscle_strengths
    np.testing.assert_allclose(ratio, 1.25**power, rtol=1e-3)


def test_local_size_follows_the_part_of_the_face_that_is_larger(template):
    mesh = SkinMesh(template, template.neutral({"chin_height": 1.0, "chin_width": 1.0}))
    scale = mesh.local_scale
    assert scale[mesh.landmark("chin")] > 1.02
    assert abs(scale[mesh.landmark("hairline")] - 1) < 0.005


def test_excursions_are_in_proportion(template, person):
    mesh, attached = person
    canonical = SkinMesh(template, template.vertices)
    count = int(template.num_skin_vertices)
    for row in anatomy.muscle_table():
        place = find_place(canonical, *row["measured_at"], 0, "L")
        mode = attached.muscle_modes[attached.muscle_names.index(f"{row['name']}.L")]
        moved = mesh.refinement.positions(np.ascontiguousarray(mode[:count]))[place.vertex]
        expected = 1e-3 * row["excursion_mm"] * place.scale(mesh)
        assert np.linalg.norm(moved) == pytest.approx(expected, rel=1e-6)
        assert 0.7 < place.scale(mesh) < 1.3, row["name"]


def test_both_sides_of_a_symmetric_face_move_alike(template, person):
    _, attached = person
    left, right = attached.muscle_modes[::2], attached.muscle_modes[1::2]
    # Identity modes are stored in single precision
    assert np.abs(right[:, template.mirror] * SYMMETRY - left).max() < 1e-5


def test_motion_spreads_in_proportion_and_stays_even(template, usual, person):
    mesh, attached = person
    canonical = SkinMesh(template, template.vertices)
    for row in anatomy.muscle_table():
        name = f"{row['name']}.L"
        index = usual.muscle_names.index(name)
        own, other = attached.muscle_modes[index], usual.muscle_modes[index]
        size = find_place(canonical, *row["measured_at"], 0, "L").scale(mesh)
        cosine = (own * other).sum() / np.linalg.norm(own) / np.linalg.norm(other)
        assert cosine > 0.85, name
        ratio = spread(mesh.neutral, own) / spread(template.vertices, other)
        assert ratio == pytest.approx(size, rel=0.15), name
        assert np.linalg.norm(own, axis=1).max() < 0.02 * size, name
