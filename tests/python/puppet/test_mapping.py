# SPDX-License-Identifier: GPL-3.0-or-later
"""From scores to muscles."""

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.muscles.anatomy import muscle_groups, muscle_names
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.performance.gaze import GAZE
from mimetic.puppet.mapping import Mapping
from mimetic.puppet.parts import FACE, PARTS, channels_of
from sample_taught import make_taught

MODES = [("parts", "linear"), ("parts", "gaussian"), ("face", "linear"), ("face", "gaussian")]


def test_each_muscle_and_articulator_is_of_one_part_and_all_are_the_faces():
    names = (muscle_names(), muscle_groups().tolist(), [*ARTICULATORS, *GAZE])
    count = len(names[0]) + len(names[2])
    owned = [channel for part in PARTS for channel in channels_of(part, *names)]
    assert sorted(owned) == list(range(count)) == channels_of(FACE, *names)
    left = channels_of("eye.L", *names)
    assert all(([*names[0], *names[2]])[i].endswith(".L") for i in left) and len(left) >= 5


@pytest.mark.parametrize(("mode", "basis"), MODES)
def test_taught_looks_give_their_states(mode, basis):
    taught = make_taught(noise=0)
    mapping = Mapping(taught, mode, basis)
    for look in range(3):
        row = taught.example_scores[8 * look]
        np.testing.assert_allclose(mapping.state(row).values, taught.look_values[look], atol=0.03)


@pytest.mark.parametrize("basis", ["linear", "gaussian"])
def test_a_part_that_changes_moves_its_own_muscles_alone(basis):
    taught = make_taught()
    mapping = Mapping(taught, "parts", basis)
    rest, smile = taught.example_scores[0].copy(), taught.example_scores[8]
    before = mapping.state(rest).values
    mouth = taught.of_part("mouth")
    rest[mouth] = smile[mouth]
    after = mapping.state(rest).values
    assert after[0] > before[0] + 0.5
    assert after[2] == before[2]


def test_by_the_whole_face_nothing_beyond_the_taught_looks_comes_out():
    taught = make_taught()
    mapping = Mapping(taught, "face")
    random = np.random.default_rng(1)
    for _ in range(30):
        values = mapping.state(random.uniform(-1, 1, 8)).values
        # In the hull of (0 0 0 0), (.8 .6 0 .1), (0 0 .9 .5)
        smile, surprise = values[0] / 0.8, values[2] / 0.9
        assert min(smile, surprise) > -1e-9 and smile + surprise < 1 + 1e-6
        np.testing.assert_allclose(values[1], 0.6 * smile, atol=1e-6)
        np.testing.assert_allclose(values[3], 0.1 * smile + 0.5 * surprise, atol=1e-6)


def test_neutral_takes_todays_scores_as_at_rest():
    taught = make_taught(noise=0)
    mapping = Mapping(taught)
    dimmer = taught.example_scores[0] - np.linspace(0.05, 0.2, 8)
    assert np.abs(mapping.state(dimmer).values).max() > 0.05
    mapping.set_neutral(dimmer)
    np.testing.assert_allclose(mapping.state(dimmer).values, taught.look_values[0], atol=0.03)


def test_doubt_grows_away_from_all_that_was_taught():
    taught = make_taught()
    mapping = Mapping(taught)
    near, far = mapping.state(taught.example_scores[3]), mapping.state(np.full(8, -0.9))
    assert (far.std[:4] > 2 * near.std[:4]).all()


def test_a_set_without_templates_for_a_mode_says_so():
    whole = make_taught()
    keep = whole.of_part("face")
    pixels = np.concatenate([whole.pictures[i].ravel() for i in keep])
    taught = make_taught(
        template_parts=["face"] * 3,
        template_looks=whole.template_looks[keep],
        template_boxes=whole.template_boxes[keep],
        template_pixels=pixels,
        example_scores=whole.example_scores[:, keep],
    )
    with pytest.raises(InvalidInput, match="--mode face"):
        Mapping(taught, "parts")


def with_gaze(**changes):
    """The same set with a gaze, in degrees, which wanders in every look."""
    taught = make_taught(noise=0)
    wander = np.tile([12.0, -12.0], len(taught.example_values) // 2)
    return make_taught(
        noise=0,
        channels=[*taught.channels, "gaze_yaw.L"],
        channel_groups=np.append(taught.channel_groups, 0),
        look_values=np.column_stack([taught.look_values, [0.0, 0.0, 9.0]]),
        limits=np.column_stack([taught.limits, [-90.0, 90.0]]),
        example_values=np.column_stack([taught.example_values, wander]),
        **changes,
    )


def test_the_gazes_degrees_do_not_outweigh_a_smile():
    taught = with_gaze()
    taught.example_values[8:16, 4] = 12  # which the look itself does not
    smile = Mapping(taught, "face").state(taught.example_scores[8]).values
    np.testing.assert_allclose(smile[:2], [0.8, 0.6], atol=0.15)


def test_neutral_is_the_face_at_rest_wherever_it_looks():
    taught = with_gaze()
    taught.example_values[8:16, 4] = 0  # smiles that look straight ahead, as the neutral look does
    mapping = Mapping(taught)
    mapping.set_neutral(taught.example_scores[0])
    assert np.abs(mapping.neutral_shift).max() < 1e-9
