# SPDX-License-Identifier: GPL-3.0-or-later
"""Controls driven live take the values that a bake of the same performance keys."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.puppet.driven_face import DrivenControls
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.take import Take
from mimetic.retarget.bone_channels import nearest_surface
from mimetic.retarget.controls import ControlRow
from mimetic.retarget.playing import play
from surfaces import make_surface, renamed


@pytest.fixture(scope="module")
def live(rendered_clip):
    live, take = LiveFilter(stillness=0, in_background=False), Take(25.0)
    states = [
        live.advance(image, (n - 1) / 25)
        for n, image in Footage(rendered_clip.footage).frames(1, 30)
    ]
    for state in states:
        take.add(state, live.face)
    return live, states, take.performance()


def make(kind):
    surface = make_surface(has_muscles=kind != "names alone")
    rows = [ControlRow("jawOpen", gain=0.5, offset=0.1), ControlRow("browInnerUp")]
    return {
        "names and muscles": (surface,),
        "names alone": (surface,),
        "other names": (renamed(surface),),
        "a table": (surface, rows),
        "nearest surface": (renamed(surface), None, nearest_surface()),
    }[kind]


@pytest.mark.parametrize(
    "kind", ["names and muscles", "names alone", "other names", "a table", "nearest surface"]
)
def test_a_state_gives_what_a_bake_keys(live, kind):
    filtered, states, performance = live
    given = make(kind)
    played, driven = play(performance, *given), DrivenControls(*given)
    assert driven.names == played.names
    for row in (0, 12, 29):
        values = driven.values(filtered.names, states[row], filtered.face)
        assert list(values) == played.names
        # What names alone say is fitted on the canonical head live, on the person's own in a bake
        np.testing.assert_allclose(list(values.values()), played.values[row], atol=1e-2)
    assert np.ptp(played.values, axis=0).max() > 0.1


def test_without_muscles_and_known_names_there_is_nothing_to_go_by():
    with pytest.raises(InvalidInput, match="no muscles are attached"):
        DrivenControls(renamed(make_surface(has_muscles=False)))
