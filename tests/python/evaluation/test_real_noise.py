# SPDX-License-Identifier: GPL-3.0-or-later
"""What points move by where a face keeps still, and what they are off by once a bias is known."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core

from evaluation.runs.real_labels import POINTS, read_labels
from evaluation.runs.real_noise import POINTS_OF, Sightings, noise_text
from evaluation.runs.real_score import score_places, without_bias
from evaluation.runs.real_still import RUN, in_crops, jitter, shrunk, with_frames

RNG = np.random.default_rng(7)


def test_jitter_is_what_a_steady_motion_leaves():
    spread = np.array([0.02, 0.05])
    ticks = np.arange(RUN)[:, None, None]
    moving = ticks * np.array([0.3, -0.2]) + RNG.normal(0, spread, (400, RUN, 3, 2))
    found = np.sqrt(jitter(moving).mean(axis=(0, 1)))
    np.testing.assert_allclose(found, spread, rtol=0.05)


def test_places_in_a_crop_turn_and_grow_with_it():
    crops = [_core.FeatureCrop([50, 40], side, roll) for side, roll in ((20, 0.0), (40, 0.6))]
    shares = np.array([0.25, -0.1])
    places = np.stack(
        [
            crop.center
            + crop.side
            * np.array(
                [
                    np.cos(crop.roll) * shares[0] - np.sin(crop.roll) * shares[1],
                    np.sin(crop.roll) * shares[0] + np.cos(crop.roll) * shares[1],
                ]
            )
            for crop in crops
        ]
    )
    np.testing.assert_allclose(in_crops(places[:, None], crops)[:, 0], [shares, shares])


def test_a_bias_is_known_from_the_other_frames_alone():
    off = np.array([[[1.0]], [[2.0]], [[np.nan]], [[6.0]]])
    left = without_bias(off)
    np.testing.assert_allclose(left[:, 0, 0], [1 - 4, 2 - 3.5, np.nan, 6 - 1.5])


def test_frames_without_marks_join_the_marked_ones():
    labels = read_labels("single_face")
    every = with_frames(labels, np.array([2, 13, 90]))
    assert set(every.frame) == {*labels.frame, 2, 90}
    np.testing.assert_array_equal(
        every.rows(np.isin(every.frame, labels.frame)).places, labels.places
    )
    assert np.isnan(every.places[np.isin(every.frame, (2, 90))]).all()


def test_a_smaller_picture_has_the_means_of_the_larger():
    image = np.arange(7 * 9 * 3, dtype=np.uint8).reshape(7, 9, 3)
    np.testing.assert_array_equal(shrunk(image, 3)[1, 2], image[3:6, 6:9].mean(axis=(0, 1)))
    assert shrunk(image, 3).shape == (2, 3, 3)


def test_jitter_of_a_method_is_counted_across_margins():
    labels = read_labels("single_face")
    variances = np.tile([4e-4, 1e-4], (len(POINTS), 1))
    scored = score_places(labels, "moved", labels.places, variances)
    assert scored.figures["inner lips"]["jitter"] == pytest.approx(1)
    assert scored.figures["iris"]["jitter"] == pytest.approx(100 * np.sqrt(5e-4))


def test_the_table_pools_clips_and_says_what_the_core_says():
    clips = [
        Sightings(
            1,
            dict.fromkeys(POINTS_OF, 100.0),
            {name: np.full((3, 2), spread**2) for name in POINTS_OF},
            {name: np.full((5, 2, 2), 0.01) for name in POINTS_OF},
        )
        for spread in (0.001, 0.001)
    ]
    text = noise_text(clips)
    assert text.count("\n") == len(POINTS_OF)
    assert f"{100 * _core.feature_noise('iris', 100).error[1]:.3f}" in text
    assert "0.100" in text and "1.000" in text


def test_the_core_says_more_noise_of_a_smaller_crop():
    for name in POINTS_OF:
        large, small, tiny = (_core.feature_noise(name, side) for side in (400, 30, 8))
        assert (large.jitter > 0).all() and (large.error >= large.jitter).all(), name
        assert (tiny.error > 2 * large.error).all(), name
        assert (small.error >= large.error).all(), name
    with pytest.raises(InvalidInput, match="positive"):
        _core.feature_noise("iris", 0)
    with pytest.raises(InvalidInput, match="no such value"):
        _core.feature_noise("nose", 10)
