# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.sparse_curves import (
    count_keys,
    sparse_keys,
    sparse_rotation,
    sparse_together,
)
from sample_performance import make_performance

FRAMES = np.arange(1.0, 101)


def event(start, height=0.8):
    return height * np.interp(FRAMES, start + np.array([0, 8, 16, 30]), (0, 1, 1, 0))


def played(keys, frames=FRAMES):
    """Cubics of the keys and their handles, which end a third of the way."""
    values = []
    for t in frames:
        i = int(
            np.clip(np.searchsorted(keys.points[:, 0], t, "right") - 1, 0, len(keys.points) - 2)
        )
        (t0, a), (_, b) = keys.points[i], keys.right[i]
        (t1, d), (_, c) = keys.points[i + 1], keys.left[i + 1]
        s = (t - t0) / (t1 - t0)
        values.append(
            a * (1 - s) ** 3 + 3 * b * s * (1 - s) ** 2 + 3 * c * s**2 * (1 - s) + d * s**3
        )
    return np.array(values)


@pytest.mark.parametrize("tolerance", [0.005, 0.02])
def test_few_keys_keep_to_the_curve_between_frames_too(tolerance):
    """Motion blur, and scenes at other rates, show what is played there."""
    random = np.random.default_rng(0)
    values = np.repeat(random.uniform(0, 1, 25), 4)  # jumps from frame to frame
    keys = sparse_keys(FRAMES, values, tolerance)
    between = np.linspace(1, 100, 991)
    at = np.clip(between.astype(int) - 1, 0, 98)
    low, high = np.minimum(values[at], values[at + 1]), np.maximum(values[at], values[at + 1])
    shown = played(keys, between)
    assert np.maximum(low - shown, shown - high).max() < 0.12
    assert np.abs(played(keys) - values).max() < 1.001 * tolerance


@pytest.mark.parametrize("tolerance", [0.01, 0.02, 0.05])
def test_few_keys_stay_within_the_error_that_is_stated(tolerance):
    values = event(10) + event(55, 0.5) + 0.01 * np.sin(FRAMES)
    keys = sparse_keys(FRAMES, values, tolerance)
    error = np.abs(played(keys) - values).max()
    assert error == pytest.approx(keys.error, abs=1e-9)
    assert error <= tolerance
    assert len(keys.points) < 30


@pytest.mark.parametrize("rate", [24, 60, 30 * 1.001, 30 * 30 / 23.976])
@pytest.mark.parametrize("by_phases", [False, True])
def test_few_keys_keep_to_straight_lines_at_the_frames_of_another_rate(rate, by_phases):
    """Of blinks filmed at 30 frames a second."""
    frames = 1 + (FRAMES - 1) * rate / 30
    values = sum(
        np.interp(FRAMES, start + np.array([0, 2, 3, 6]), (0, 1, 1, 0)) for start in (9, 40)
    )
    keys = sparse_keys(frames, values, 0.02, by_phases)
    together = sparse_together(frames, np.column_stack([values, np.roll(values, 1)]), 0.02)[0]
    whole = np.arange(1, int(frames[-1] + 1e-6) + 1)
    for few in (keys, together):
        for at in (frames, whole):
            missed = np.abs(played(few, at) - np.interp(at, frames, values)).max()
            assert missed <= few.error + 1e-9 <= 0.02 + 2e-9
        assert len(few.points) < len(whole)


def test_what_rests_rests_and_a_still_curve_is_one_key():
    keys = sparse_keys(FRAMES, event(30))
    assert np.abs(played(keys)[:28]).max() < 1e-4
    assert np.abs(played(keys)[61:]).max() < 1e-4
    assert len(sparse_keys(FRAMES, np.zeros(100)).points) == 1
    assert len(sparse_keys(FRAMES[:1], np.ones(1)).points) == 1


def test_wrong_input_is_refused():
    with pytest.raises(InvalidInput, match="tolerance"):
        sparse_keys(FRAMES, FRAMES, 0)
    with pytest.raises(InvalidInput, match="rise"):
        sparse_keys(FRAMES[::-1], FRAMES)
    with pytest.raises(InvalidInput, match="finite"):
        sparse_keys(FRAMES, FRAMES * np.nan)


@pytest.mark.parametrize("exponent", [-2.0, 0.0, 2.0])
def test_keys_by_phases_are_four_to_six_an_event_at_its_phases(exponent):
    shape = _core.PhaseShape()
    shape.amplitude, shape.onset, shape.rise, shape.hold = 0.7, 20.0, 12.0, 10.0
    shape.exponent, shape.release_time = exponent, 5.0
    # A capture's smoother leaves no corners; a key has one slope
    weights = np.hanning(9)[1:-1] / np.hanning(9).sum()
    values = np.convolve(np.pad(shape.values(FRAMES), 3, mode="edge"), weights, "valid")
    keys = sparse_keys(FRAMES, values, by_phases=True)
    assert np.abs(played(keys) - values).max() <= 0.02
    (count,) = keys.keys_of_event
    assert 4 <= count <= 6
    near = [np.abs(keys.points[:, 0] - t).min() for t in (shape.onset, shape.apex, shape.release)]
    assert max(near) <= 2.5, keys.points
    # The event's ends rest: a drag within it moves nothing beyond
    inside = (keys.points[:, 1] > 0.02).sum()
    assert inside <= count - 1


def test_keys_by_phases_count_each_event_and_hold_the_tolerance():
    values = event(8) + event(55, 0.5) + 0.008 * np.sin(FRAMES)
    keys = sparse_keys(FRAMES, values, 0.02, by_phases=True)
    assert len(keys.keys_of_event) == 2
    assert np.abs(played(keys) - values).max() == pytest.approx(keys.error, abs=1e-9)
    assert keys.error <= 0.02
    still = sparse_keys(FRAMES, np.zeros(100), by_phases=True)
    assert len(still.points) == 1 and still.keys_of_event == []


def test_keys_of_a_performance_are_counted():
    performance = make_performance(40)
    for by_phases in (False, True):
        count = count_keys(performance, 0.02, by_phases)
        assert 0 < count.few < count.dense == 40 * 38
        assert count.error <= 0.02
        assert bool(count.keys_of_event) == by_phases


def test_curves_that_are_keyed_together_have_keys_at_the_same_frames():
    rows = np.stack([event(10), -event(40, 0.3), np.full(100, 0.25)], axis=1)
    keys = sparse_together(FRAMES, rows, 0.01)
    for one, values in zip(keys, rows.T, strict=True):
        np.testing.assert_array_equal(one.points[:, 0], keys[0].points[:, 0])
        error = np.abs(played(one) - values).max()
        assert error == pytest.approx(one.error, abs=1e-9)
        assert error <= 0.01
    assert 4 < len(keys[0].points) < 40
    still = sparse_together(FRAMES, rows[:, 2:], 0.01)
    assert len(still[0].points) == 1


@pytest.mark.parametrize("mode", ["QUATERNION", "AXIS_ANGLE", "XYZ", "ZYX"])
def test_a_rotation_by_few_keys_is_as_near_as_stated(mode):
    from mimetic.character.rig_motion import rotation_channels

    vectors = np.stack([0.6 * event(10), 0.4 - event(40, 0.5), 0.2 * np.sin(FRAMES / 9)], axis=1)
    path, rows = rotation_channels(_core.from_rotation_vectors(vectors), mode)
    tolerance = np.radians(0.2)
    keys, error = sparse_rotation(FRAMES, rows, path, tolerance)
    assert error <= tolerance
    assert len(keys[0].points) < 56
    few = np.stack([played(one) for one in keys], axis=1)
    if path == "rotation_quaternion":
        few /= np.linalg.norm(few, axis=1, keepdims=True)
        angles = 2 * np.arccos(np.clip(np.abs((few * rows).sum(axis=1)), 0, 1))
    elif path == "rotation_axis_angle":
        axes = [
            row[:, 1:] / np.linalg.norm(row[:, 1:], axis=1, keepdims=True) for row in (few, rows)
        ]
        angles = np.linalg.norm(few[:, :1] * axes[0] - rows[:, :1] * axes[1], axis=1)
    else:
        angles = np.abs(few - rows).sum(axis=1)  # of turns one after the other, at most
    assert angles.max() <= error + 1e-9
