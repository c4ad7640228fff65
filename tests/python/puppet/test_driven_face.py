# SPDX-License-Identifier: GPL-3.0-or-later
"""A live state on a face in a scene gives what a bake of the same performance gives."""

import numpy as np
import pytest
from mimetic.character.rig_motion import carried_channels, motion
from mimetic.character.shapes import shapes_of, slider_shapes_of
from mimetic.puppet.driven_face import (
    EYE_TURN,
    Stand,
    channel_of_slider,
    head_channels,
    slider_values,
)
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.take import Take


@pytest.fixture(scope="module")
def live(rendered_clip):
    from mimetic.media.footage import Footage

    live = LiveFilter(stillness=0, in_background=False)
    states = [
        live.advance(image, (n - 1) / 25)
        for n, image in Footage(rendered_clip.footage).frames(1, 30)
    ]
    take = Take(25.0)
    for state in states:
        take.add(state, live.face)
    return live, states, take.performance()


@pytest.mark.parametrize("shapes_by", [shapes_of, slider_shapes_of])
def test_sliders_are_as_a_bake_keys_them(live, shapes_by):
    filtered, states, performance = live
    shapes = {shape.name: shape.values for shape in shapes_by(performance)}
    assert (EYE_TURN in shapes) == (shapes_by is shapes_of)
    for row in (0, 12, 29):
        values = slider_values(filtered.names, states[row].values, filtered.face.lids, set(shapes))
        assert values.keys() == shapes.keys()
        for name, value in values.items():
            assert value == pytest.approx(shapes[name][row], abs=1e-6), name


def test_the_head_moves_as_a_bake_moves_it(live):
    _, _, performance = live
    rest = motion(performance, rest_frame=1)
    stand = Stand(np.eye(4), np.zeros(3), np.eye(3), "QUATERNION")
    baked = carried_channels(rest, np.zeros(3), np.eye(3), np.eye(4), np.eye(3), "QUATERNION")
    poses = performance.head_pose
    for row in (0, 12, 29):
        shown = head_channels(poses[row : row + 1], poses[0], stand)
        np.testing.assert_allclose(shown.locations[0], baked.locations[row], atol=1e-9)
        np.testing.assert_allclose(np.abs(shown.rotations[0] @ baked.rotations[row]), 1, atol=1e-9)


def test_sliders_of_eyes_are_the_eyes():
    assert {channel_of_slider(name) for name in ("eye_left.L", "look_up.R", "lid_upper.L")} == {
        "eyes"
    }
    assert channel_of_slider("jaw_open") == "mouth"
