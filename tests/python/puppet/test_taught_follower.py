# SPDX-License-Identifier: GPL-3.0-or-later
"""A taught set beside the live filter: what of it is used, and what it changes."""

import pytest
from mimetic import InvalidInput
from mimetic.puppet.live_face import live_names
from mimetic.puppet.taught_follower import TaughtFollower
from sample_taught import make_taught

LIVE = ["zygomaticus_major.L", "zygomaticus_major.R", "frontalis_medial.L", "jaw_open"]


@pytest.fixture(scope="module")
def names():
    return live_names()


def test_a_use_that_is_none_is_said(names):
    with pytest.raises(InvalidInput, match="sharpen or drive, not 'blend'"):
        TaughtFollower(make_taught(), names, "blend")


def test_a_set_of_other_muscles_is_refused(names):
    with pytest.raises(InvalidInput, match="move no muscle that is followed live"):
        TaughtFollower(make_taught(channels=["a.L", "a.R", "b.L", "c"]), names)


def test_what_no_example_moves_is_left_to_the_live_filter(names):
    taught = make_taught()
    values = taught.example_values.copy()
    values[:, 3] = 0.0
    looks = taught.look_values.copy()
    looks[:, 3] = 0.0
    channels = [name if name in names else names[0] for name in LIVE]
    still = make_taught(channels=channels, example_values=values, look_values=looks)
    whole = TaughtFollower(make_taught(channels=channels), names)
    assert names.index("jaw_open") in whole._live
    follower = TaughtFollower(still, names)
    assert follower._live == [i for i in whole._live if i != names.index("jaw_open")]
