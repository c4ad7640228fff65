# SPDX-License-Identifier: GPL-3.0-or-later
"""What a face's sliders do is an expression's channels, and comes back as it was."""

import numpy as np
import pytest
from mimetic.character.gaze_shapes import LOOKS, TURNS
from mimetic.library.face_sliders import limits_on, with_gaze, with_groups, without_gaze
from mimetic.performance.gaze import GAZE

LIDS = ("lid_upper.L", "lid_upper.R")
SMILE = "zygomaticus_major.L"
PER_DEGREE = (0.02, 0.015)


def sliders(stems):
    return [SMILE, *LIDS, *(f"{stem}.{side}" for stem in stems for side in "LR")]


@pytest.mark.parametrize("stems", [TURNS, LOOKS])
def test_eyes_of_either_kind_give_the_gaze_that_they_were_given(stems):
    channels = [SMILE, *LIDS, *GAZE]
    values = np.array([[0.4, 0.1, 0.2, 20, -15, 16, 10], [0] * 7, [0, 0, 0, -30, 20, -28, -25]])
    names, shown = without_gaze(channels, values, sliders(stems), PER_DEGREE)
    assert sorted(names) == sorted(sliders(stems))
    assert not shown[1].any()  # at rest all is at rest
    again, back = with_gaze(names, shown, PER_DEGREE)
    assert sorted(again) == sorted(channels)
    order = [again.index(name) for name in channels]
    np.testing.assert_allclose(back[:, order], values, atol=1e-9)


def test_lids_go_along_with_eyes_that_shapes_turn():
    names, shown = without_gaze(GAZE, np.array([[0, -20, 0, 0.0]]), sliders(TURNS), PER_DEGREE)
    by_name = dict(zip(names, shown[0], strict=True))
    assert by_name["lid_upper.L"] == pytest.approx(0.4) and "lid_upper.R" not in by_name


def test_a_face_whose_eyes_do_not_turn_leaves_the_gaze():
    values = np.array([[0.4, 20.0]])
    names, shown = without_gaze([SMILE, GAZE[0]], values, [SMILE], PER_DEGREE)
    assert names == [SMILE, GAZE[0]] and np.array_equal(shown, values)
    assert with_gaze([SMILE], values[:, :1], PER_DEGREE)[0] == [SMILE]


def test_a_groups_slider_counts_as_its_muscles():
    names, rows = with_groups(
        [SMILE, "risorius.L", "Lip Corners"],
        np.array([[0.2, 0.0, 0.5], [0.1, 0.3, -0.1]]),
        {"Lip Corners": [SMILE, "risorius.L", "of no key"], "Eye Ring": [SMILE]},
    )
    assert names == [SMILE, "risorius.L"]
    np.testing.assert_allclose(rows, [[0.7, 0.5], [0.0, 0.2]])


def test_limits_are_the_sliders_own():
    limits = limits_on([SMILE, "AU12.L", "gaze_yaw.L"], {SMILE: (0, 1), "AU12.L": (0, 2)})
    assert limits.tolist() == [[0, 0, -90], [1, 2, 90]]
