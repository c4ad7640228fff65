# SPDX-License-Identifier: GPL-3.0-or-later
"""Smiles: eyes beside mouth, how fast, how even, beside what others have published."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.analyse.estimate import WITHIN, Estimate
from mimetic.analyse.tables import interval_cells
from mimetic.analyse.timing import SIDES, Event, GroupDelay, Timing

MOUTH, EYES = 1, 7  # groups


@dataclass(frozen=True)
class Published:
    """What others measured, in the unit of a `Smile`'s field."""

    field: str
    text: str
    lower: float
    upper: float
    source: str


# Published ranges of other people's smiles, measured by other means: for comparison only
PUBLISHED = (
    Published(
        "rise_seconds",
        "onset of spontaneous smiles; it does not depend on the context",
        0.40,
        0.70,
        "Schmidt, Cohn and Tian 2003, Biological Psychology 65; about half a second is quoted",
    ),
    Published(
        "rise_seconds",
        "onset of posed smiles: faster",
        0.20,
        0.40,
        "Schmidt et al. 2006 and 2009, J. Nonverbal Behavior 30 and 33; a third of a second quoted",
    ),
    Published(
        "total_seconds",
        "length of felt smiles",
        0.5,
        4.0,
        "Ekman and Friesen 1982, J. Nonverbal Behavior 6, as quoted",
    ),
)
# Published as a direction; the seconds behind it are not drawn, as they are not quoted elsewhere
LONGER = (
    "Genuine smiles of UvA-NEMO (597, beside 643 posed ones) rise, stay and fall longer than posed "
    "ones, and more slowly (Guo et al. 2018, Frontiers in Psychology 9, 202): a direction, without "
    "a band."
)
BLINK = "Eyes close in a blink for 0.1 to 0.4 s: an eye event as short may be one."


@dataclass(frozen=True)
class Smile:
    """One event of the lip-corner pullers. Frames, seconds, activation; sides are the subject's."""

    event: Event
    eye_event: Event | None
    rise_seconds: Estimate
    total_seconds: Estimate  # until a tenth of the height is left
    onset_speed: Estimate  # activation a second
    asymmetry: Estimate  # (left - right) / (left + right), -1 to 1
    eye_ratio: Estimate  # eye group's amplitude over the mouth group's
    eye_delay: GroupDelay | None


def smiles_of(timing: Timing) -> list[Smile]:
    """The certain events of the mouth group, each with what the eyes do meanwhile."""
    fps = timing.performance.fps
    return [_smile(event, timing, fps) for event in timing.of_group(MOUTH) if event.fit.is_certain]


def _smile(event: Event, timing: Timing, fps: float) -> Smile:
    fit = event.fit
    eyes = _overlapping(event, timing)
    delay = next(
        (pair for pair in timing.delays if pair.leader is event and pair.follower is eyes), None
    )
    rise, rise_spread = fit.apex.value - fit.onset.value, _gap(fit.onset, fit.apex)
    blank = Estimate(math.nan, math.nan, math.nan)
    begins = not fit.begins_before
    whole = begins and not fit.ends_after
    amplitude = event.amplitude
    climb = fit.shape.climb / fit.shape.amplitude  # a smile may begin from half of another
    onset = Estimate(rise / fps, max(0.0, rise - rise_spread) / fps, (rise + rise_spread) / fps)
    return Smile(
        event,
        eyes,
        onset if begins else blank,
        _seconds(fit.length, fps) if whole else blank,
        _quotient(_times(amplitude, climb), onset) if begins else blank,
        _asymmetry(event, timing),
        _quotient(eyes.amplitude, amplitude) if eyes else blank,
        delay,
    )


def _overlapping(event: Event, timing: Timing) -> Event | None:
    """The strongest certain event of the eyes that overlaps."""
    fits = [
        eyes
        for eyes in timing.of_group(EYES)
        if eyes.fit.is_certain and _overlap(eyes, event, timing) > 0
    ]
    return max(fits, key=lambda eyes: eyes.fit.amplitude.value, default=None)


def _overlap(one: Event, other: Event, timing: Timing) -> float:
    """Frames from the later onset to the earlier release, negative if they are apart.

    What is cut off counts as far as it is seen: its fit goes on beyond the scene.
    """
    frames = timing.performance.frame
    first, last = zip(*(_seen_part(event.fit, frames) for event in (one, other)), strict=True)
    return min(last) - max(first)


def _seen_part(fit: _core.PhaseFit, frames: NDArray[np.int64]) -> tuple[float, float]:
    """From onset to release, within the frames that were fitted."""
    first, last = float(frames[fit.first]), float(frames[fit.last])
    return max(fit.onset.value, first), min(fit.release.value, last)


def _asymmetry(event: Event, timing: Timing) -> Estimate:
    """Of the mouth group's two sides, where one of them has an event at least.

    What a fit gets wrong it gets wrong on both sides, so that only each side's own error counts.
    """
    events = [_side_event(side, event, timing) for side in SIDES]
    if not any(events):
        return Estimate(math.nan, math.nan, math.nan)
    strongest = max(filter(None, events), key=lambda one: one.fit.amplitude.value)
    left, right = (
        _about(own.fit.amplitude) if own else _rise(side, strongest, timing)
        for side, own in zip(SIDES, events, strict=True)
    )
    whole = left.value + right.value
    value = (left.value - right.value) / whole
    slopes = (2 * right.value / whole**2, 2 * left.value / whole**2)
    spread = math.hypot(slopes[0] * _half(left), slopes[1] * _half(right))
    return Estimate(value, max(-1.0, value - spread), min(1.0, value + spread))


def _side_event(side: str, event: Event, timing: Timing) -> Event | None:
    """That of one side of the mouth which overlaps most."""
    same = [
        other
        for other in timing.of_kind("side")
        if other.curve.group == MOUTH
        and other.curve.name.endswith(side)
        and _overlap(other, event, timing) > 0
    ]
    return max(same, key=lambda other: _overlap(other, event, timing), default=None)


def _rise(side: str, other: Event, timing: Timing) -> Estimate:
    """How far one side of the mouth rises, which has no event, while the other side has one."""
    curve = next(
        curve
        for curve in timing.curves
        if curve.kind == "side" and curve.group == MOUTH and curve.name.endswith(side)
    )
    frames = (other.fit.onset.value, other.fit.apex.value)
    values, stds = (
        np.interp(frames, timing.performance.frame, y) for y in (curve.values, curve.stds)
    )
    value, spread = max(0.0, float(values[1] - values[0])), WITHIN * math.hypot(*stds)
    return Estimate(value, value - spread, value + spread)


def _times(estimate: Estimate, factor: float) -> Estimate:
    return Estimate(*(factor * bound for bound in (estimate.value, estimate.lower, estimate.upper)))


def _about(interval: _core.Interval) -> Estimate:
    return Estimate(interval.value, interval.lower, interval.upper)


def _seconds(frames: _core.Interval, fps: float) -> Estimate:
    return Estimate(frames.value / fps, max(0.0, frames.lower) / fps, frames.upper / fps)


def _half(estimate: Estimate) -> float:
    return (estimate.upper - estimate.lower) / 2


def _gap(first: _core.Interval, second: _core.Interval) -> float:
    return math.hypot((first.upper - first.lower) / 2, (second.upper - second.lower) / 2)


def _quotient(one: Estimate, other: Estimate) -> Estimate:
    value = one.value / other.value
    spread = abs(value) * math.hypot(_half(one) / one.value, _half(other) / other.value)
    return Estimate(value, max(0.0, value - spread), value + spread)


def smile_rows(smiles: list[Smile]) -> list[dict[str, object]]:
    rows = []
    for smile in smiles:
        row: dict[str, object] = {"event": smile.event.number}
        for field in ("rise_seconds", "total_seconds", "onset_speed", "asymmetry", "eye_ratio"):
            row |= interval_cells(field, getattr(smile, field))
        delay = smile.eye_delay.delay if smile.eye_delay else None
        row |= interval_cells("eye_delay_frames", delay.lag if delay else None)
        row["eye_is_delayed"] = delay.is_delayed if delay else ""
        rows.append(row)
    return rows


def summary_of(smile: Smile) -> str:
    """What the numbers say, in words, and no more."""
    parts = [f"Lip corners, event {smile.event.number}, peak {_amplitude(smile.event)}."]
    if smile.event.fit.begins_before:
        parts.append("It is there when the clip, or its scene, begins: its onset is not known.")
    else:
        onset = smile.rise_seconds
        parts.append(
            f"Onset {smile.event.fit.onset.value:.1f}, {onset.value:.2f} s long "
            f"({onset.lower:.2f} to {onset.upper:.2f})."
        )
    parts.append(_eye_words(smile))
    uneven = smile.asymmetry
    if math.isfinite(uneven.value):
        if uneven.lower > 0 or uneven.upper < 0:
            side = "left" if uneven.value > 0 else "right"
            parts.append(f"Stronger on the subject's {side} ({uneven.value:+.2f}).")
        else:
            parts.append(f"No significant difference between the sides ({uneven.value:+.2f}).")
    return " ".join(parts)


def _eye_words(smile: Smile) -> str:
    if smile.eye_event is None:
        return "No contraction about the eyes exceeds the capture's own error."
    ratio = smile.eye_ratio
    words = (
        f"The eye group contracts too, {ratio.value:.1f} times as much "
        f"({ratio.lower:.1f} to {ratio.upper:.1f})"
    )
    if smile.eye_delay is None:
        events = smile.event, smile.eye_event
        if any(event.fit.begins_before for event in events):
            return f"{words}; which began first is not known."
        return f"{words}; it begins too far apart for a delay to be measured."
    lag = smile.eye_delay.delay.lag
    times = f"{lag.value:+.1f} frames, {lag.lower:+.1f} to {lag.upper:+.1f}"
    if smile.eye_delay.delay.is_delayed:
        return f"{words}, {'after' if lag.value > 0 else 'before'} the mouth ({times})."
    return f"{words}; no significant delay ({times})."


def _amplitude(event: Event) -> str:
    amplitude = event.amplitude
    return f"{amplitude.value:.2f} ({amplitude.lower:.2f} to {amplitude.upper:.2f})"
