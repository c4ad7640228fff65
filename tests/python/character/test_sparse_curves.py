# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.character.sparse_curves import sparse_keys

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


@pytest.mark.parametrize("tolerance", [0.01, 0.02, 0.05])
def test_few_keys_stay_within_the_error_that_is_stated(tolerance):
    values = event(10) + event(55, 0.5) + 0.01 * np.sin(FRAMES)
    keys = sparse_keys(FRAMES, values, tolerance)
    error = np.abs(played(keys) - values).max()
    assert error == pytest.approx(keys.error, abs=1e-9)
    assert error <= tolerance
    assert len(keys.points) < 30


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
