# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys of a curve with their handles, and what edits make of them: smoother, larger, later."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.muscles.sides import mirrored_name, mirrored_sign

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
MOST_SECONDS = 10.0  # of smoothing
MOST_FACTOR = 10.0  # of exaggeration
SLOPE_STEP = 1e-2  # frames, over which a curve's slope is measured
SAMPLES_A_FRAME = 4


@dataclass(frozen=True)
class CurveKeys:
    """Keys of one curve: frame and value each, K x 2, of the key and of its two handles."""

    points: Floats
    left: Floats
    right: Floats

    def affine(self, factor: float, offset: float, is_chosen: Flags | None = None) -> CurveKeys:
        """Values of the chosen keys (K; all if None) times `factor`, plus `offset`."""
        factors = np.array([1.0, factor])
        offsets = np.array([0.0, offset])
        return self._changed(is_chosen, *(rows * factors + offsets for rows in self._rows()))

    def limited(
        self, lowest: float, highest: float, is_chosen: Flags | None = None
    ) -> tuple[CurveKeys, int]:
        """Chosen keys and their handles within limits; how many keys lay beyond."""
        low, high = np.array([[-np.inf, lowest], [np.inf, highest]])
        keys = self._changed(is_chosen, *(np.clip(rows, low, high) for rows in self._rows()))
        return keys, int((keys.points[:, 1] != self.points[:, 1]).sum())

    def retimed(self, first: float, last: float, factor: float, shift: float = 0.0) -> CurveKeys:
        """The same values in another time: `_core.retimed_frames`, then `shift` frames later."""

        def later(rows: Floats) -> Floats:
            frames = _core.retimed_frames(rows[:, 0].copy(), first, last, factor) + shift
            return np.column_stack([frames, rows[:, 1]])

        return CurveKeys(*map(later, self._rows()))

    def smoothed(self, frames: Floats, values: Floats, width: float, is_chosen: Flags) -> CurveKeys:
        """Chosen keys where the curve lies without what changes faster than `width` frames.

        Their handles are those with which the cubics between keys lie nearest to it. frames,
        values: N samples of the curve, at `sample_frames`. Raises InvalidInput.
        """
        if width == 0:
            return self
        at = np.ascontiguousarray(self.points[:, 0])
        smooth_values, slopes = _core.smooth_keys(frames, values, at, width)
        keys = cubic_keys(at, smooth_values, slopes, slopes)
        return self._changed(is_chosen, keys.points, keys.left, keys.right)

    def _rows(self) -> tuple[Floats, Floats, Floats]:
        return self.points, self.left, self.right

    def _changed(self, is_chosen: Flags | None, *rows: Floats) -> CurveKeys:
        if is_chosen is not None:
            pairs = zip(self._rows(), rows, strict=True)
            rows = tuple(np.where(is_chosen[:, None], new, old) for old, new in pairs)
        return replace(self, points=rows[0], left=rows[1], right=rows[2])


@dataclass(frozen=True)
class Samples:
    """A curve at M frames, and how it arrives at each and leaves it, a frame."""

    values: Floats
    left_slopes: Floats
    right_slopes: Floats


def cubic_keys(frames: Floats, values: Floats, left: Floats, right: Floats) -> CurveKeys:
    """Keys with these slopes on either side.

    Handles end a third of the way to the neighbouring key, so that the curve is a cubic in time.
    """
    spans = np.diff(frames) / 3
    before = np.concatenate([spans[:1], spans]) if len(spans) else np.ones(1)
    after = np.concatenate([spans, spans[-1:]]) if len(spans) else np.ones(1)
    return CurveKeys(
        np.column_stack([frames, values]),
        np.column_stack([frames - before, values - before * left]),
        np.column_stack([frames + after, values + after * right]),
    )


def sample_frames(key_frames: Floats) -> Floats:
    """Frames to sample a curve with these keys (K frames, rising) at, evenly, and closely enough
    for what lies between keys."""
    first, last = key_frames[0], key_frames[-1]
    return np.linspace(first, last, int(np.ceil((last - first) * SAMPLES_A_FRAME)) + 1)


def slope_frames(frames: Floats) -> Floats:
    """5 M frames at which a curve is evaluated for its `samples` at M frames."""
    steps = SLOPE_STEP * np.array([-2.0, -1.0, 0.0, 1.0, 2.0])
    return (frames[:, None] + steps).reshape(-1)


def samples(values: Floats) -> Samples:
    """Of a curve's values (5 M) at `slope_frames`."""
    rows = values.reshape(-1, 5)
    before, right_before, at, right_after, after = rows.T
    return Samples(
        at.copy(),
        (3 * at - 4 * right_before + before) / (2 * SLOPE_STEP),
        (4 * right_after - 3 * at - after) / (2 * SLOPE_STEP),
    )


def mixed(frames: Floats, shares: Sequence[tuple[float, Samples]]) -> CurveKeys:
    """The sum of curves times their shares, keyed at `frames` (M).

    These hold all keys of all of them; the sum of curves that are cubics in time is exact then.
    """
    parts = [
        sum(share * getattr(part, name) for share, part in shares)
        for name in ("values", "left_slopes", "right_slopes")
    ]
    return cubic_keys(frames, *parts)


def twin_of(shape: str) -> tuple[str, float]:
    """The shape at the same place on the other side, and what values are multiplied by there."""
    return mirrored_name(shape), mirrored_sign(shape)


def check_width(seconds: float) -> None:
    """Raises InvalidInput for smoothing outside 0 to MOST_SECONDS."""
    if not 0 <= seconds <= MOST_SECONDS:
        raise InvalidInput(
            f"smoothing of curves over {seconds:g} s: it must lie between 0 and {MOST_SECONDS:g}"
        )


def check_factor(factor: float) -> None:
    """Raises InvalidInput for exaggeration outside 0 to MOST_FACTOR."""
    if not 0 <= factor <= MOST_FACTOR:
        raise InvalidInput(f"exaggeration {factor:g}: it must lie between 0 and {MOST_FACTOR:g}")
