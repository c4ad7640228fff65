# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's 52 shapes on heads of other makes."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.foreign_head import attach_foreign
from mimetic.template.face_template import load_template

from evaluation.anatomy.closed_eyes import seen_area
from evaluation.synthetic.characters import EYEBALL, GLTF, OTHER, Recipe, Style, made

SCALE = 1.2


@pytest.fixture(scope="module")
def bound():
    """A person of another size and make, and the 52 shapes."""
    person = made(Recipe("person", 121, 0.3, 0.0, GLTF, SCALE), load_template())
    head = attach_foreign(person.vertices, person.triangles, person.truth, load_template())
    return person, head, head.make_units()


def mode(units, name) -> np.ndarray:
    return units.modes[units.names.index(name)]


def at(person, name) -> int:
    return int(np.abs(person.vertices - person.truth[name]).sum(1).argmin())


def lower_teeth(person) -> np.ndarray:
    """Rows of the lower of the two parts with as many vertices as the template's lower teeth."""
    label = np.arange(len(person.vertices))
    for _ in range(60):
        least = label[person.triangles].min(1)
        for corner in range(3):
            np.minimum.at(label, person.triangles[:, corner], least)
    count = len(load_template().part_vertices("teeth_lower"))
    parts = [np.flatnonzero(label == one) for one in np.unique(label)]
    parts = [part for part in parts if len(part) == count]
    return min(parts, key=lambda part: person.vertices[part, 1].mean())


def test_they_have_arkits_names_and_every_one_moves_the_head(bound):
    _, _, units = bound
    assert len(set(units.names)) == 52
    assert {"jawOpen", "mouthClose", "eyeBlinkLeft", "eyeLookInRight", "tongueOut"} <= set(
        units.names
    )
    largest = np.sqrt((units.modes**2).sum(2)).max(1)
    assert largest.min() > 1e-3
    assert largest.max() < 0.06
    assert units.notes == ()


def test_lids_close_and_lips_meet(bound):
    _, _, units = bound
    assert set(units.gaps_mm) == {"eyeBlinkLeft", "eyeBlinkRight", "mouthClose"}
    assert max(units.gaps_mm.values()) < 0.3


def test_lids_stay_outside_of_the_eyeballs(bound):
    _, _, units = bound
    assert set(units.depths_mm) == {"eyeBlinkLeft", "eyeBlinkRight"}
    assert max(units.depths_mm.values()) < 0.2


def test_no_eyeball_is_seen_behind_shut_lids(bound):
    person, head, units = bound
    in_head = head.mesh_from_template.inverse()
    drawn = (person.kind != OTHER)[person.triangles].all(axis=1)
    seen = {}
    for blinks in (0, 1):
        motion = blinks * (mode(units, "eyeBlinkLeft") + mode(units, "eyeBlinkRight"))
        seen[blinks] = [
            seen_area(
                in_head.apply(person.vertices + motion),
                np.ascontiguousarray(person.triangles[drawn]),
                person.kind == EYEBALL,
                centre,
            )
            for centre in in_head.apply(head.eye_centers)
        ]
    assert min(seen[0]) > 50
    assert max(seen[1]) < 0.5


def test_lids_of_a_decimated_head_close():
    units = units_of(Recipe("person", 122, 0.3, 0.5, GLTF, SCALE))
    assert max(units.gaps_mm.values()) < 0.3


def test_large_eyes_are_found_and_shut():
    units = units_of(Recipe("large eyes", 123, 0.1, 0.5, GLTF, SCALE, Style(eyes=1.6)))
    assert set(units.depths_mm) == {"eyeBlinkLeft", "eyeBlinkRight"}
    assert units.gaps_mm["eyeBlinkLeft"] < 0.3
    assert units.gaps_mm["eyeBlinkRight"] < 0.3


def test_lids_that_are_one_surface_are_told_and_not_pulled_together():
    units = units_of(Recipe("sealed", 124, 0.3, 0.0, GLTF, SCALE, Style(is_sealed=True)))
    assert set(units.gaps_mm) == {"mouthClose"}
    assert units.depths_mm == {}
    assert (
        "the left lids have no opening of their own: eyeBlinkLeft cannot close them" in units.notes
    )
    assert np.abs(mode(units, "eyeBlinkLeft")).max() > 1e-3


def units_of(recipe):
    person = made(recipe, load_template())
    return attach_foreign(
        person.vertices, person.triangles, person.truth, load_template()
    ).make_units()


def test_a_jaw_that_is_open_with_closed_lips_keeps_the_lips_together(bound):
    person, _, units = bound
    upper, lower = at(person, "lip_upper_inner"), at(person, "lip_lower_inner")
    chin = at(person, "chin")

    def gap(motion):
        shape = person.vertices + motion
        return shape[upper] - shape[lower]

    rest, open_jaw = gap(0), mode(units, "jawOpen")
    assert np.abs(gap(open_jaw) - rest).max() > 0.02
    assert np.abs(gap(open_jaw + mode(units, "mouthClose")) - rest).max() < 1e-3
    assert mode(units, "mouthClose")[chin, 1] < 0.75 * -open_jaw[chin, 1]


def test_what_is_on_the_jaw_follows_it_rigidly(bound):
    person, _, units = bound
    teeth = lower_teeth(person)
    moved = mode(units, "jawOpen")[teeth]
    assert np.sqrt((moved**2).sum(1)).min() > 0.01
    before, after = person.vertices[teeth], person.vertices[teeth] + moved
    lengths = [np.sqrt(((x[:, None] - x[None]) ** 2).sum(2)) for x in (before, after)]
    assert np.abs(lengths[0] - lengths[1]).max() < 1e-4


def test_left_is_the_subjects_own(bound):
    person, _, units = bound
    corners = {side: at(person, f"mouth_corner.{side}") for side in "LR"}
    smile = np.sqrt((mode(units, "mouthSmileLeft") ** 2).sum(1))
    assert smile[corners["L"]] > 3 * smile[corners["R"]]
    assert mode(units, "jawLeft")[at(person, "chin"), 0] > 1e-3
    assert mode(units, "jawRight")[at(person, "chin"), 0] < -1e-3


def test_maps_carry_a_displacement_with_the_stretch_of_the_skin():
    side = np.linspace(0, 1, 5)
    flat = np.array([(x, y, 0.0) for x in side for y in side])
    faces = np.array(
        [
            corners
            for i in range(4)
            for j in range(4)
            for a in [5 * i + j]
            for corners in ((a, a + 5, a + 6), (a, a + 6, a + 1))
        ],
        np.int32,
    )
    turn = np.array([[0.0, -2, 0], [2, 0, 0], [0, 0, 2]])  # a quarter turn, twice as large
    maps = _core.surface_maps(flat, flat @ turn.T + 3, faces)
    moves = np.tile([0.1, 0.2, 0.3], (25, 1))
    np.testing.assert_allclose(_core.carried_by(maps, moves), moves @ turn.T, atol=2e-3)
    with pytest.raises(InvalidInput):
        _core.surface_maps(flat, flat[1:], faces)
