# SPDX-License-Identifier: GPL-3.0-or-later
"""An expression cut out of a performance: a motion with its phases, or its peak as a still."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.analyse.timing import Event, Timing
from mimetic.library.expression import Expression, limits_of
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE

# Channels that stay nearer to rest are left out: they are the capture's noise
LEAST_VALUE, LEAST_TURN = 0.03, 3.0  # the gaze's in degrees
SOONER = 3  # frames by which another group may begin before the event that is cut


def cut_motion(
    timing: Timing,
    frames: tuple[int, int] | None = None,
    group: int | None = None,
    number: int | None = None,
    only: tuple[int, ...] = (),
    is_from_rest: bool = True,
) -> Expression:
    """The frames of an event, or those named, as a motion.

    timing: with events of groups; frames: first and last, both included; group: whose event, of
    the strongest if None; number: which of its events, counted from 1; only: groups whose muscles
    are kept, without jaw and lids, all and these if empty; is_from_rest: values less the straight
    line between the first and the last frame, so that it begins and ends at rest. Raises
    InvalidInput.
    """
    performance, event = timing.performance, None
    if frames is None:
        event = _event(timing, group, number)
        first, last = _rows_of(event, timing)
    elif group is not None or number is not None:
        raise InvalidInput("frames and an event cannot both be given")
    else:
        first, last = (performance.index_of(frame) for frame in frames)
    if last - first < 2:
        raise InvalidInput("an expression needs three frames or more")
    numbers = performance.frame[first : last + 1]
    if len(numbers) != numbers[-1] - numbers[0] + 1:
        raise InvalidInput(
            f"frames {numbers[0]} to {numbers[-1]} are not all in the performance: cut where none "
            "is missing"
        )
    channels, values, stds = _channels(performance, slice(first, last + 1), only)
    limits = limits_of(channels, performance.muscles)
    moving_channels, moving = _moving(channels, values, limits, is_from_rest)
    if not moving_channels:
        if not is_from_rest or not _moving(channels, values - values.min(axis=0), limits, False)[0]:
            raise InvalidInput(f"nothing moves from frame {numbers[0]} to {numbers[-1]}")
        is_cut = event is not None and event.fit.begins_before
        why = "; the event begins before the clip, or its scene" if is_cut else ""
        raise InvalidInput(
            f"less than {LEAST_VALUE:g} (of the gaze {LEAST_TURN:g} degrees) is left of what moves "
            f"from frame {numbers[0]} to {numbers[-1]} once the straight line between the two is "
            f"taken off{why}; try --as-captured"
        )
    names, events = _phases(timing, first, last, only)
    name = performance.footage[0] if performance.footage else ""
    source = [name, f"{numbers[0]} to {numbers[-1]}"]
    fps = performance.fps
    moving_stds = stds[:, [channels.index(name) for name in moving_channels]]
    return Expression(moving_channels, moving, moving_stds, fps, names, events, source)


def from_curves(
    channels: list[str], values: NDArray[np.float64], fps: float, limits: NDArray[np.float64]
) -> Expression:
    """A motion (N x C) or a still (1 x C) of what sliders do; raises InvalidInput if none moves.

    limits: 2 x C, least and greatest values.
    """
    is_motion = len(values) > 1
    moving_channels, moving = _moving(
        channels, np.asarray(values, dtype=np.float64), limits, is_motion
    )
    if not moving_channels:
        raise InvalidInput("no slider is moved: there is no expression to keep")
    return Expression(moving_channels, moving, np.zeros_like(moving), fps)


def _moving(
    channels: list[str],
    values: NDArray[np.float64],
    limits: NDArray[np.float64],
    is_from_rest: bool,
) -> tuple[list[str], NDArray[np.float64]]:
    """The channels that leave rest, and their values."""
    if is_from_rest:
        values = _core.from_rest(values)
    values = np.clip(values, *limits)
    is_gaze = np.isin(channels, GAZE)
    most = np.abs(values).max(axis=0)
    moves = most >= LEAST_VALUE
    # One eye that stayed would squint
    moves[is_gaze] = (most[is_gaze] >= LEAST_TURN).any()
    return [name for name, one in zip(channels, moves, strict=True) if one], values[:, moves]


def _event(timing: Timing, group: int | None, number: int | None) -> Event:
    events = timing.of_kind("group") if group is None else timing.of_group(group)
    if number is not None:
        if group is None:
            raise InvalidInput("an event is counted within its group: give the group too")
        if not 1 <= number <= len(events):
            raise InvalidInput(
                f"group {group} has {len(events)} events (phases.csv of `mimetic analyse` lists "
                f"them); there is no {number}"
            )
        return events[number - 1]
    whole = [event for event in events if event.fit.is_certain and not event.fit.begins_before]
    if not whole:
        raise InvalidInput(
            "there is no event that is certain and begins within the clip; name frames to keep"
        )
    return max(whole, key=lambda event: event.fit.shape.amplitude)


def _rows_of(event: Event, timing: Timing) -> tuple[int, int]:
    """First and last row of an event, with those of other groups that begin while it lasts."""
    first, last = event.fit.first, event.fit.last
    begin, end = event.fit.shape.onset, timing.performance.frame[last]
    for other in timing.of_kind("group"):
        onset = other.fit.shape.onset
        is_with = begin - SOONER <= onset < min(end, event.fit.shape.release)
        if other.fit.is_certain and not other.fit.begins_before and is_with:
            first, last = min(first, other.fit.first), max(last, other.fit.last)
    return first, last


def _channels(
    performance: Performance, rows: slice, only: tuple[int, ...]
) -> tuple[list[str], NDArray[np.float64], NDArray[np.float64]]:
    is_member = (
        np.isin(performance.groups, only) if only else np.ones(len(performance.groups), bool)
    )
    names = [name for name, keeps in zip(performance.muscles, is_member, strict=True) if keeps]
    values = performance.activations[rows][:, is_member]
    stds = performance.activations_std[rows][:, is_member]
    if only:
        if not names:
            raise InvalidInput(f"the performance has no muscles of the groups {only}")
        return names, values, stds
    bones = performance.articulator_values[rows]
    bone_stds = performance.articulator_values_std
    bone_stds = np.zeros_like(bones) if bone_stds is None else bone_stds[rows]
    names = names + performance.articulators
    return names, np.hstack([values, bones]), np.hstack([stds, bone_stds])


def _phases(
    timing: Timing, first: int, last: int, only: tuple[int, ...]
) -> tuple[list[str] | None, NDArray[np.float64] | None]:
    """Names of groups and onset, apex, release (rows from the first), amplitude of their events."""
    frames = timing.performance.frame
    rows = []
    for event in timing.of_kind("group"):
        shape = event.fit.shape
        within = frames[first] <= shape.onset and shape.apex <= frames[last]
        if event.fit.is_certain and within and (not only or event.curve.group in only):
            times = np.array([shape.onset, shape.apex, shape.release]) - frames[first]
            rows.append((event.curve.name, [*times, shape.amplitude]))
    if not rows:
        return None, None
    return [name for name, _ in rows], np.array([values for _, values in rows])
