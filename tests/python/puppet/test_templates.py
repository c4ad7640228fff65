# SPDX-License-Identifier: GPL-3.0-or-later
"""The file of a taught set."""

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.puppet.templates import TaughtSet
from sample_taught import make_taught


def test_a_set_is_read_as_it_was_written(tmp_path):
    taught = make_taught()
    taught.save(tmp_path / "set.npz")
    again = TaughtSet.load(tmp_path / "set.npz")
    assert (again.looks, again.channels, again.template_parts, again.footage) == (
        *(taught.looks, taught.channels, taught.template_parts, taught.footage),
    )
    np.testing.assert_array_equal(again.example_scores, taught.example_scores)
    for one, other in zip(again.pictures, taught.pictures, strict=True):
        np.testing.assert_array_equal(one, other)
    assert again.pictures[3].shape == (16, 24)
    assert again.muscles == ["puller.L", "puller.R", "raiser.L"] and again.articulators == [
        "jaw_open"
    ]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"neutral": 3}, "neutral names a look"),
        ({"template_looks": np.array([0, 1, 2, 0, 1, 2, 0, 5])}, "template_looks"),
        ({"template_parts": ["nose"] * 8}, "'nose'"),
        ({"template_boxes": np.array([[4, 4, 400, 50]] * 8)}, "leave the view"),
        ({"template_boxes": np.array([[4, 4, 4, 4]] * 8)}, "pixels a side"),
        ({"template_pixels": np.zeros(7, np.uint8)}, "not as many"),
        ({"example_scores": np.full((24, 8), np.nan)}, "example_scores is not finite"),
        ({"channel_groups": np.array([0, 1, 5, 0])}, "muscles first"),
        ({"pixel": 1.0}, "pixel"),
        ({"sides": np.array([0.03, -0.03, -0.035, 0.035])}, "sides"),
        ({"looks": ["a", "a", "b"]}, "distinct"),
        ({"limits": np.array([[1.0] * 4, [0.0] * 4])}, "limits"),
    ],
)
def test_what_a_set_cannot_be_is_refused(changes, message):
    with pytest.raises(InvalidInput, match=message):
        make_taught(**changes)


def test_other_files_are_refused_in_a_line(tmp_path, performance):
    performance.save(tmp_path / "performance.npz")
    with pytest.raises(InvalidInput, match="lacks the key pixel; teach again"):
        TaughtSet.load(tmp_path / "performance.npz")
    (tmp_path / "text.npz").write_text("no archive")
    with pytest.raises(UnreadableMedia, match="taught set"):
        TaughtSet.load(tmp_path / "text.npz")
