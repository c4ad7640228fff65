# SPDX-License-Identifier: GPL-3.0-or-later
"""A fit that rests on more than one frame, and its mesh drawn as lines."""

import numpy as np
import pytest
from drawn_face import draw
from mimetic import InvalidInput
from mimetic.fit.fitting import NoFace, find_face, landmark_places, refit
from mimetic.fit.further_frame import with_frame
from mimetic.fit.lines import fit_lines
from mimetic.template.face_template import load_template
from test_fit import CAMERA, pose

NAME = "mouth_corner.L"


@pytest.fixture(scope="module")
def pictures():
    template = load_template()
    turned = pose(12, 4, 3, (0.03, 0, 0.55))
    poses = (pose(0, 0, 0), turned)
    return [draw(template, template.vertices, where, CAMERA) for where in poses]


@pytest.fixture(scope="module")
def fitted(pictures):
    return find_face(pictures[0], 7, camera=CAMERA)


@pytest.fixture(scope="module")
def pinned(fitted):
    x, y = landmark_places(fitted)[NAME]
    return refit(fitted, {NAME: (x + 3, y)})


@pytest.fixture(scope="module")
def both(pinned, pictures):
    return with_frame(pinned, pictures[1], 30)


def test_another_frame_joins_and_pins_stay(both, pinned):
    assert [view.frame for view in both.views] == [7, 30]
    assert both.frame == 7
    assert both.pins == pinned.pins
    x, y = landmark_places(both)[NAME]
    assert np.hypot(x - pinned.pins[7][NAME][0], y - pinned.pins[7][NAME][1]) < 0.5
    # The head turned between them, and each view has a pose of its own
    assert np.abs(both.views[0].head_pose - both.views[1].head_pose).max() > 0.1


def test_its_landmarks_can_be_pinned_and_let_go_of(both):
    x, y = landmark_places(both, 30)["chin"]
    moved = refit(both, {"chin": (x, y + 3)}, 30)
    assert set(moved.pins) == {7, 30}
    assert abs(landmark_places(moved, 30)["chin"][1] - y - 3) < 0.5
    assert set(refit(moved, {}, 30).pins) == {7}


def test_a_frame_measured_again_keeps_its_pins(pinned, pictures):
    again = with_frame(pinned, pictures[0], 7)
    assert [view.frame for view in again.views] == [7]
    assert again.pins == pinned.pins


def test_what_does_not_fit_the_footage_is_refused(fitted, pictures):
    with pytest.raises(InvalidInput, match="480 x 400"):
        with_frame(fitted, pictures[1][:200], 30)
    with pytest.raises(NoFace):
        with_frame(fitted, np.full_like(pictures[1], 90), 30)


def test_lines_lie_on_the_face_of_their_frame(both):
    for frame in (7, 30):
        lines = fit_lines(both, frame)
        assert len(lines) > 500
        places = landmark_places(both, frame)
        x = np.array([places[f"zygion.{side}"][0] for side in "RL"])
        y = np.array([places[name][1] for name in ("hairline", "menton")])
        middle = lines.reshape(-1, 2).mean(axis=0) * [480, -400] + [-0.5, 399.5]
        assert x[0] < middle[0] < x[1]
        assert y[0] < middle[1] < y[1]
        lengths = np.linalg.norm(lines[:, 0] - lines[:, 1], axis=1)
        assert lengths.max() < 0.05
    assert len(fit_lines(both, 8)) == 0
