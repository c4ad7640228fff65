# SPDX-License-Identifier: GPL-3.0-or-later
"""A list of corrections changed bit by bit, and what a frame is as it states it."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.library.composing import canonical_person
from mimetic.muscles.feature_lines import feature_lines
from mimetic.performance.corrections import FrameCorrection, SkinPin
from mimetic.solve import correcting
from mimetic.solve.stated import captured_state, stated_state
from mimetic.template.face_template import load_template

FRAME = 1
LID, MUSCLE = "lid_upper.L", "zygomaticus_major.L"


@pytest.fixture(scope="module")
def person():
    """The canonical head with a smile and an open mouth."""
    rest = canonical_person()
    activations, values = rest.activations.copy(), rest.articulator_values.copy()
    activations[0, rest.muscles.index(MUSCLE)] = 0.7
    values[0, rest.articulators.index("jaw_open")] = 0.5
    return replace(rest, activations=activations, articulator_values=values)


def pins(count: int) -> tuple[SkinPin, ...]:
    return tuple(SkinPin(face, (1.0, 0.0, 0.0, 0.0), (face, 0.0)) for face in range(count))


def everything(person) -> tuple[FrameCorrection, ...]:
    """A frame in which all that can be stated is."""
    stated = (FrameCorrection(FRAME, pins=pins(2)),)
    stated = correcting.with_value(stated, FRAME, LID, 0.9, 0, 8)
    stated = correcting.with_value(stated, FRAME, "lip_gap", 0.004, 0, 8)
    return correcting.with_turn(stated, person, FRAME, (0, 3, 0), (0.01, 0, 0), 8)


def test_each_thing_that_is_stated_is_taken_back_by_its_name(person):
    stated = everything(person)
    names = correcting.parts_of(stated[0])
    assert names == ["pin 1", "pin 2", "pose", LID, "lip_gap"]
    for name in names:
        left = correcting.parts_of(correcting.without(stated, FRAME, name)[0])
        expected = [other for other in names if other != name]
        # Pins are counted anew
        assert left == [n if n != "pin 2" or name != "pin 1" else "pin 1" for n in expected]
    second = correcting.without(stated, FRAME, "pin 1")[0].pins
    assert [pin.face for pin in second] == [1]
    assert correcting.without(stated, FRAME) == ()
    for name in ("pin 1", "pin 1", "pose", LID, "lip_gap"):
        stated = correcting.without(stated, FRAME, name)
    assert stated == (), "a frame in which nothing is stated any more is none"


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("pin 3", "frame 1 has 2 pins"),
        ("pin x", "frame 1 has 2 pins"),
        ("jaw_open", "frame 1: jaw_open is not corrected"),
    ],
)
def test_what_is_not_stated_is_not_taken_back(person, what, words):
    with pytest.raises(InvalidInput, match=words):
        correcting.without(everything(person), FRAME, what)
    with pytest.raises(InvalidInput, match="nothing is corrected in frame 7"):
        correcting.without(everything(person), 7, "pose")
    with pytest.raises(InvalidInput, match="no pose is corrected"):
        correcting.without(correcting.without(everything(person), FRAME, "pose"), FRAME, "pose")


def test_a_value_is_as_stated_where_it_is_and_as_captured_elsewhere(person):
    stated = everything(person)
    assert correcting.value_at(person, FRAME, LID, stated) == 0.9
    assert correcting.value_at(person, FRAME, LID) == 0
    assert correcting.value_at(person, FRAME, MUSCLE, stated) == pytest.approx(0.7)
    assert correcting.value_at(person, FRAME, "lip_gap", stated) == 0.004


def measured_gap(vertices) -> float:
    """Metres, the mean at three places of the mouth (docs/guide/corrections.md)."""
    heights = []
    for lip in ("upper", "lower"):
        line = feature_lines(load_template())[f"lip_{lip}_inner"]
        places = [line[round(share * (len(line) - 1))] for share in (0.3, 0.5, 0.7)]
        heights.append(vertices[places, 1])
    return float(np.mean(heights[0] - heights[1]))


def test_the_lips_gap_is_that_of_the_surface(person):
    found = correcting.value_at(person, FRAME, "lip_gap")
    assert found == pytest.approx(measured_gap(person.surface(0)), abs=1e-6)
    assert found > 0.005, "the mouth is open"


def test_a_turn_is_read_back_as_it_was_stated(person):
    turn, shift = (4.0, -7.0, 2.0), (0.01, -0.02, 0.05)
    stated = correcting.with_turn((), person, FRAME, turn, shift, 8, 0.2, 0.05)
    for read, given in zip(correcting.turn_at(stated, person, FRAME), (turn, shift), strict=True):
        np.testing.assert_allclose(read, given, atol=1e-9)
    assert (stated[0].pose.rotation_std, stated[0].pose.translation_std) == (0.2, 0.05)
    np.testing.assert_array_equal(correcting.turn_at((), person, FRAME), np.zeros((2, 3)))


def test_a_stated_frame_has_what_is_stated_and_the_rest_as_captured(person):
    captured, entry = captured_state(person, 0), everything(person)[0]
    state = stated_state(person, 0, entry)
    lid = person.articulators.index(LID)
    assert state.articulators[lid] == 0.9
    np.testing.assert_array_equal(state.activations, captured.activations)
    np.testing.assert_array_equal(state.head_pose, entry.pose.head_pose)
    modes = np.concatenate([person.muscle_modes, person.articulator_modes])
    values = np.concatenate([state.activations, state.articulators])
    moved = person.neutral_vertices + np.tensordot(values, modes, 1)
    assert measured_gap(moved) == pytest.approx(0.004, abs=1e-6)


def test_both_eyes_go_along_with_one_that_is_stated(person):
    entry = correcting.with_value((), FRAME, "gaze_yaw.R", 20.0, 0, 8)[0]
    gaze = stated_state(person, 0, entry).gaze
    assert gaze[2] == pytest.approx(20, abs=1) and gaze[0] > 10
    assert correcting.states_more_than_pins(entry)
    assert not correcting.states_more_than_pins(FrameCorrection(FRAME, pins=pins(1)))
    assert not correcting.states_more_than_pins(None)


def test_each_value_has_its_unit(person):
    kinds = {name: correcting.kind_of(name) for name in correcting.value_names(person)}
    assert kinds["lip_gap"] == "gap" and kinds["gaze_pitch.R"] == "angle"
    assert kinds["jaw_open"] == kinds[MUSCLE] == "share"
    assert kinds["jaw_side"] == kinds[LID] == "signed"
    assert correcting.kind_of("oris_close_upper") == "closing"
