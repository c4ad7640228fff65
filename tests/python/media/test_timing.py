# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.media.timing import exact_rate, footage_frames, frame_steps, scene_frames, scene_rate

NTSC_FILM, NTSC = 24000 / 1001, 30000 / 1001


@pytest.mark.parametrize(
    ("clip", "scene", "frame", "expected"),
    [
        (25, 25, 100, 100),
        (25, 24, 26, 25),  # one second later
        (24, 25, 25, 26),
        (NTSC_FILM, 24, 24001, 24025),  # 1001 s: a scene at 24 needs 24024 frames for them
        (24, NTSC_FILM, 24025, 24001),
        (NTSC, 30, 30001, 30031),
        (30, NTSC, 30031, 30001),
        (NTSC, NTSC_FILM, 6, 5),  # 5 frames in 4
        (60, 24, 6, 3),
        (25, 24, 2, 1.96),
    ],
)
def test_seconds_stay_seconds(clip, scene, frame, expected):
    assert scene_frames([frame], clip, scene)[0] == pytest.approx(expected, abs=1e-6)


def test_single_precision_rates_give_whole_frames():
    single = float(np.float32(24) / np.float32(1.001))
    frames = np.arange(1, 100_001)
    np.testing.assert_array_equal(scene_frames(frames, NTSC_FILM, single), frames)


def test_start_and_offset_move_the_frames():
    assert scene_frames([1], 25, 24, frame_start=101)[0] == 101
    assert scene_frames([11], 25, 50, frame_start=1, frame_offset=10)[0] == 1
    assert scene_frames([12], 25, 50, frame_start=1, frame_offset=10)[0] == 3


def test_there_and_back_is_the_same_frame():
    frames = np.arange(1, 500)
    placed = scene_frames(frames, NTSC, 24, 7, 3)
    np.testing.assert_allclose(footage_frames(placed, NTSC, 24, 7, 3), frames, atol=1e-9)


def test_equal_rates_need_no_steps():
    assert frame_steps(np.arange(1, 50), NTSC_FILM, float(np.float32(24 / 1.001))) is None


@pytest.mark.parametrize("rate", [29.83, 625 / 29, 14.985, 119.5])
def test_a_rate_that_a_scene_rounds_to_single_precision_is_the_same(rate):
    own = scene_rate(rate)
    rounded = own.fps / float(np.float32(own.fps_base))
    frames = np.arange(1, 100_000, 101)
    assert frame_steps(frames, rate, rounded) is None
    np.testing.assert_array_equal(scene_frames(frames, rate, rounded), frames)
    assert frame_steps(frames, rate, rate * 1.00005) is not None


@pytest.mark.parametrize(("clip", "scene"), [(25, 24), (24, 25), (NTSC, 24), (60, 24), (12, 30)])
def test_steps_show_the_last_frame_that_has_begun(clip, scene):
    frames = np.arange(5, 120)
    steps = frame_steps(frames, clip, scene, frame_start=11)
    shown = steps.offsets + steps.scene_frames - 11 + 1
    seconds_shown = (shown - 1) / clip
    seconds_now = (steps.scene_frames - 11) / scene
    inside = (seconds_now >= (frames[0] - 1) / clip) & (seconds_now <= (frames[-1] - 1) / clip)
    late = (seconds_now - seconds_shown)[inside]
    assert late.min() > -1e-6
    assert late.max() < 1 / clip


@pytest.mark.parametrize("rate", [24, NTSC_FILM, 25, NTSC, 12.5, 59.94005994, 15.238])
def test_a_scene_of_its_own_plays_at_the_clips_rate(rate):
    result = scene_rate(rate)
    assert isinstance(result.fps, int)
    assert result.fps / result.fps_base == pytest.approx(rate, rel=1e-6)


@pytest.mark.parametrize("rate", [0, -25, np.nan, np.inf])
def test_a_rate_that_is_none_is_refused(rate):
    with pytest.raises(InvalidInput, match="frame rate"):
        exact_rate(rate)
