# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames far from the reference frame: what lies between is gone through, and told."""

from types import SimpleNamespace

import pytest
from mimetic import InvalidInput
from mimetic.solve import clip_capture
from mimetic.solve.walk import ClipWalk, before_range


@pytest.fixture(scope="module")
def fit(fit_of_frame_3):
    return fit_of_frame_3


@pytest.mark.parametrize(
    ("frames", "expected"),
    [
        ((1, 9), ""),
        ((3, 3), ""),
        ((20, 22), "17 frames from the reference frame 3 to 20"),
        ((1, 2), "1 frame from the reference frame 3 to 2"),
    ],
)
def test_what_a_walk_goes_through_first_is_told(fit, frames, expected):
    assert before_range(fit, frames) == expected


def test_a_capture_far_from_its_reference_frame_says_so_from_its_first_line(rendered_clip, fit):
    told = []

    def progress(fraction, text):
        told.append((fraction, text))
        return True

    frames = (12, 13)
    performance = clip_capture.capture(rendered_clip.footage, frames, fit, progress)
    assert performance.frame.tolist() == list(frames)
    assert "9 frames from the reference frame 3 to 12" in told[0][1]
    following = [text for _, text in told if text.startswith("following")]
    way = "following the face from the reference frame 3 to 12: frame "
    assert [text for text in following if way in text] == [f"{way}{i}" for i in range(4, 12)]
    assert following[-2:] == [
        "following the face: frame 12 of 12 to 13",
        "following the face: frame 13 of 12 to 13",
    ]
    fractions = [fraction for fraction, _ in told]
    assert fractions == sorted(fractions)
    # The way counts: nine of the ten frames are done before the first that is asked for
    before, first = (next(f for f, t in told if t == text) for text in (f"{way}4", following[-2]))
    assert first - before > 0.7 * (fractions[-1] - before)


def test_a_range_that_ends_before_it_begins_says_so(rendered_clip):
    with pytest.raises(InvalidInput, match=r"frames 50:40 of .*: the first is after the last"):
        clip_capture.find_face(rendered_clip.footage, frames=(50, 40))


def test_a_face_beside_the_picture_is_not_looked_for(rendered_clip):
    with pytest.raises(InvalidInput, match=r"at \(400, 100\): the picture has 320 x 240 pixels"):
        clip_capture.find_face(rendered_clip.footage, frame=3, near=(400.0, 100.0))


def test_frames_that_are_held_are_noted():
    walk = SimpleNamespace(
        footage=SimpleNamespace(warnings=[]),
        fit=SimpleNamespace(warnings=[]),
        summary=SimpleNamespace(stopped=False),
        subject="head",
        mixed_frames=[],
        strangers=[],
        _cuts=set(),
    )
    for quality, told in (([1, 0], "1 frame"), ([0, 1, 0], "2 frames")):
        rows = SimpleNamespace(quality=quality)
        assert f"the head was lost in {told} and is held there" in ClipWalk.notes(walk, rows)[0]
