# SPDX-License-Identifier: GPL-3.0-or-later
from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.commands.info import describe
from mimetic.performance.confounding import (
    confounded_name,
    confounded_pairs,
    confounding_text,
    with_confounding,
)
from mimetic.performance.document import Performance
from mimetic.performance.evidence import evidence_factors
from mimetic.performance.gaze import GAZE
from sample_performance import make_performance

NUM_FRAMES = 12


def evidence(rows: dict[tuple[int, int], float], num_values: int) -> np.ndarray:
    """E of one frame: each value moves a picture of its own, but for those that move one together;
    rows: what the difference of two is measured with, of what each alone is."""
    size = 6 + num_values
    information = 900.0 * np.eye(size)
    for (a, b), own in rows.items():
        alike = 900.0 * (1 - own)
        information[6 + a, 6 + b] = information[6 + b, 6 + a] = alike
    return np.append(information[np.tril_indices(size)], np.zeros(size))


def performance(seen: np.ndarray, **changes) -> Performance:
    activations = np.zeros((NUM_FRAMES, 36))
    activations[2:9, 4] = 0.6
    activations[2:9, 10] = 0.3
    return make_performance(
        num_frames=NUM_FRAMES,
        activations=activations,
        activations_std=np.full((NUM_FRAMES, 36), 0.2),
        evidence=np.tile(seen, (NUM_FRAMES, 1)),
        **changes,
    )


def test_two_that_move_one_picture_are_marked_while_one_is_at_work(tmp_path):
    found = with_confounding(performance(evidence({(4, 7): 0.001}, 38)))
    marked = found.confounded_with >= 0
    assert np.argwhere(marked.any(axis=0)).ravel().tolist() == [4, 7]
    assert np.flatnonzero(marked[:, 4]).tolist() == list(range(2, 9))
    assert confounded_name(found, 3, found.muscles[4]) == found.muscles[7]
    assert confounded_name(found, 3, found.muscles[7]) == found.muscles[4]
    assert confounded_name(found, 3, found.muscles[10]) == ""
    assert confounded_name(found, 0, found.muscles[4]) == ""
    assert confounded_name(found, 3, "jaw_open") == ""
    found.save(tmp_path / "performance.npz")
    kept = Performance.load(tmp_path / "performance.npz")
    assert np.array_equal(kept.confounded_with, found.confounded_with)


def test_the_pair_is_named_once_by_the_one_at_work():
    found = with_confounding(performance(evidence({(4, 7): 0.001}, 38)))
    (pair,) = confounded_pairs(found)
    assert (pair.muscle, pair.other) == (found.muscles[4], found.muscles[7])
    assert pair.frame.tolist() == list(range(3, 10))
    text = f"{pair.muscle} and {pair.other} (7 frames)"
    assert confounding_text(found) == text
    assert f"confounded   {text}" in describe(found)


def test_an_articulator_is_named_though_gaze_is_listed_before_it():
    """Evidence has no gaze; in the file it may stand anywhere."""
    articulators = [*GAZE, "jaw_open", "jaw_side"]
    seen = evidence({(4, 36): 0.001}, 38)
    shape = (NUM_FRAMES, len(articulators))
    found = with_confounding(
        performance(
            seen,
            articulators=articulators,
            articulator_values=np.zeros(shape),
            articulator_modes=np.zeros((len(articulators), 81, 3)),
        )
    )
    assert confounded_name(found, 3, found.muscles[4]) == "jaw_open"
    assert [(pair.muscle, pair.other) for pair in confounded_pairs(found)] == [
        (found.muscles[4], "jaw_open")
    ]


def test_how_far_a_persons_muscle_goes_changes_no_mark():
    """A file states activations, deviations and evidence relative to it."""
    plain = performance(evidence({(4, 7): 0.001}, 38))
    extent = np.ones(36)
    extent[[4, 7]] = 2.5, 1.5  # .2 / 2.5 alone would count as sure
    relative = replace(
        plain,
        activations=plain.activations / extent,
        activations_std=plain.activations_std / extent,
        evidence=plain.evidence * evidence_factors(np.append(extent, np.ones(2))),
        muscle_extent=extent,
    )
    marked = with_confounding(relative).confounded_with
    assert np.array_equal(marked, with_confounding(plain).confounded_with)
    assert (marked[:, 4] == 7).sum() == 7


def test_where_all_are_told_apart_nothing_is_said():
    found = with_confounding(performance(evidence({}, 38)))
    assert (found.confounded_with == -1).all()
    assert confounding_text(found) == "" and "confounded" not in describe(found)


def test_of_a_performance_without_evidence_nothing_is_known():
    bare = make_performance()
    assert with_confounding(bare) is bare
    assert confounded_pairs(bare) == [] and confounded_name(bare, 0, bare.muscles[0]) == ""


@pytest.mark.parametrize("index", [-2, 38])
def test_a_file_that_names_no_value_is_refused(index):
    of = np.full((NUM_FRAMES, 36), -1)
    of[5, 2] = index
    with pytest.raises(InvalidInput, match="confounded_with names values that do not exist"):
        performance(evidence({}, 38), confounded_with=of)


def test_a_file_that_names_a_muscle_for_itself_is_refused():
    of = np.full((NUM_FRAMES, 36), -1)
    of[5, 2] = 2
    with pytest.raises(InvalidInput, match="confounded_with names a muscle for itself"):
        performance(evidence({}, 38), confounded_with=of)
