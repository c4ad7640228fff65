# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character's own controls."""

import dataclasses

import numpy as np
import pytest
from acting import make_acting
from mimetic import InvalidInput
from mimetic.retarget.bone_channels import nearest_surface
from mimetic.retarget.controls import ControlRow
from mimetic.retarget.playing import play
from mimetic.retarget.unit_fit import unit_order, unit_values
from mimetic.template.face_template import load_template
from surfaces import make_surface, renamed

RISE = np.linspace(0, 1, 6)


@pytest.fixture(scope="module")
def acting():
    return make_acting({"jaw_open": RISE, "lid_upper.L": RISE[::-1], "frontalis_medial.L": RISE})


def curve(played, name: str) -> np.ndarray:
    return played.values[:, played.names.index(name)]


@pytest.mark.parametrize("has_muscles", [True, False])
def test_arkit_names_play_what_the_actor_does(acting, has_muscles):
    played = play(acting, make_surface(has_muscles=has_muscles))
    np.testing.assert_allclose(curve(played, "jawOpen"), RISE, atol=0.12)
    np.testing.assert_allclose(curve(played, "eyeBlinkLeft"), RISE[::-1], atol=0.25)
    assert np.abs(curve(played, "eyeBlinkRight")).max() < 0.05
    assert np.abs(curve(played, "noseSneerLeft")).max() < 0.1
    assert (played.explained is not None) == has_muscles
    assert (len(played.by_name) == 52) != has_muscles


def test_other_names_play_the_same_through_muscles(acting):
    surface = make_surface()
    expected = play(acting, surface)
    changed = renamed(surface)
    played = play(acting, changed)
    for name, own in zip(surface.control_names, changed.control_names, strict=True):
        if name in expected.names and own in played.names:
            np.testing.assert_allclose(curve(played, own), curve(expected, name), atol=0.06)


def test_without_muscles_and_known_names_there_is_nothing_to_go_by(acting):
    with pytest.raises(InvalidInput, match=r"no muscles are attached.*Key 00, Key 01.*46 more"):
        play(acting, renamed(make_surface(has_muscles=False)))


def test_rows_say_what_is_driven_and_how_much(acting):
    surface = make_surface()
    plain = play(acting, surface)
    rows = [
        ControlRow("jawOpen", gain=0.5, offset=0.1, highest=0.4),
        ControlRow("eyeBlinkLeft", is_on=False),
        ControlRow("browInnerUp"),
    ]
    played = play(acting, surface, rows)
    assert played.names == ["browInnerUp", "jawOpen"]
    assert curve(played, "jawOpen").min() == pytest.approx(0.1, abs=0.01)
    assert curve(played, "jawOpen").max() == pytest.approx(0.4)
    assert curve(plain, "jawOpen").max() > 0.85


def test_what_moves_no_face_is_listed_and_not_driven(acting):
    surface = make_surface()
    controls = surface.controls.copy()
    ears = surface.points[:, 1] < surface.points[:, 1].min() + 0.02  # the neck's rim
    controls[0] = 0.0
    controls[0, ears, 2] = 0.01
    names = ["NeckFat", *surface.control_names[1:]]
    played = play(acting, dataclasses.replace(surface, controls=controls, control_names=names))
    assert played.unmatched == ["NeckFat"]
    assert "NeckFat" not in played.names
    assert "unmatched: NeckFat" in played.summary()


def test_what_nobody_sees_holds_no_control_back_unless_it_is_heeded():
    # A bone of the lid that takes the tongue along, as automatic weights may have it
    acting = make_acting({"lid_upper.L": RISE})
    surface = make_surface()
    controls = surface.controls.copy()
    blink = surface.control_names.index("eyeBlinkLeft")
    controls[blink, load_template().part_vertices("tongue"), 1] = 0.003
    dragging = dataclasses.replace(surface, controls=controls)
    seen_alone = [dataclasses.replace(own, heeds_hidden=False) for own in (surface, dragging)]
    heeded, plain, free = (
        curve(play(acting, renamed(own), options=nearest_surface()), f"Key {blink:02d}").max()
        for own in (dragging, *seen_alone)
    )
    assert heeded < 0.7 * plain
    assert free == pytest.approx(plain, abs=0.05)


def test_a_known_name_without_motion_of_its_own_is_played_by_its_name(acting):
    # A mesh whose jaw is another object's: the key of the name is there for other tools
    surface = make_surface()
    controls = surface.controls.copy()
    controls[surface.control_names.index("jawOpen")] = 0.0
    played = play(acting, dataclasses.replace(surface, controls=controls))
    assert played.by_name == ["jawOpen"]
    np.testing.assert_allclose(curve(played, "jawOpen"), RISE, atol=0.12)


def test_a_name_that_lies_does_not_move_its_key():
    # "jawOpen" closes the left eye; the surface decides, the name is a weak expectation
    acting = make_acting({"jaw_open": RISE})
    surface = make_surface()
    names = list(surface.control_names)
    jaw, blink = names.index("jawOpen"), names.index("eyeBlinkLeft")
    names[jaw], names[blink] = names[blink], names[jaw]
    played = play(acting, dataclasses.replace(surface, control_names=names))
    np.testing.assert_allclose(curve(played, "eyeBlinkLeft"), RISE, atol=0.12)
    assert curve(played, "jawOpen").max() < 0.05


def test_face_units_of_a_performance(acting):
    values = unit_values(acting)
    assert values.shape == (6, 52)
    np.testing.assert_allclose(values[:, unit_order().index("jawOpen")], RISE, atol=0.12)
