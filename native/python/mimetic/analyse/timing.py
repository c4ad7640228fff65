# SPDX-License-Identifier: GPL-3.0-or-later
"""Phases of every muscle, group, jaw and upper lids of a performance, and delays of groups."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.analyse.estimate import WITHIN, Estimate
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.score.groups import GROUP_NAMES
from mimetic.shared.counted import counted
from mimetic.solve.tracking import ACTIVATION_STD, ARTICULATOR_STD, QUICKNESS

SIDES = (".L", ".R")
# Chosen on `mimetic evaluate timing --set tuning`
SHAPE_ERROR = 2.5
PICTURES_ROBUST_SCALE = 0.02  # what the pictures say is not smoothed, so one frame may be far off
EXPONENT_STD = 3.0  # beforehand, about 0
# Of an amplitude, as a share of its muscles' standard deviation and of itself
SHARED_ERROR, MODEL_ERROR = 0.75, 0.3
# What articulators do that no muscles do, as action units name it: the mean of both sides, above
# rest, or below it with "-"
COURSES = {
    "jaw_open": "opening of the jaw",
    "lid_upper": "closing of the upper lids",
    "-lid_upper": "raising of the upper lids",
}
Progress = Callable[[float, str], object]


@dataclass(frozen=True)
class Curve:
    """An actuation over time: of a muscle, a group (its muscles' mean), one side of it, or of
    articulators."""

    kind: str  # "group", "side", "muscle", "articulator"
    name: str
    group: int  # 1 to 7; 0 of articulators
    values: NDArray[np.float64]  # N, 0 to 1
    stds: NDArray[np.float64]  # N
    measured_std: float  # of the curves that were smoothed: a group's muscles
    members: NDArray[np.float64]  # P, 1 for its muscles, 0 for others
    quickness: float = 1.0  # how many times as fast as a muscle the smoother lets it be


@dataclass(frozen=True)
class Event:
    """One rise and fall of a curve; `number` counts the curve's events from 1."""

    curve: Curve
    number: int
    fit: _core.PhaseFit

    @property
    def amplitude(self) -> Estimate:
        """Its height, activation.

        Muscles of one group move nearly the same skin and are wrong together, and what a fitted
        head gets wrong grows with how far its skin moves: `fit.amplitude` counts neither.
        """
        found = self.fit.amplitude
        error = math.hypot(SHARED_ERROR * self.curve.measured_std, MODEL_ERROR * found.value)
        spread = WITHIN * error
        return Estimate(
            found.value,
            max(0.0, min(found.lower, found.value - spread)),
            max(found.upper, found.value + spread),
        )


@dataclass(frozen=True)
class GroupDelay:
    """How much later `follower` begins than `leader`, both of groups."""

    leader: Event
    follower: Event
    delay: _core.Delay


@dataclass(frozen=True)
class Timing:
    """What a performance says about when muscles fire."""

    performance: Performance
    curves: list[Curve]
    events: list[Event]
    delays: list[GroupDelay]

    def of_kind(self, kind: str) -> list[Event]:
        return [event for event in self.events if event.curve.kind == kind]

    def of_group(self, group: int) -> list[Event]:
        return [event for event in self.of_kind("group") if event.curve.group == group]


def analyse_timing(
    performance: Performance,
    progress: Progress = lambda _fraction, _text: None,
    kinds: tuple[str, ...] = ("group", "side", "muscle", "articulator"),
) -> Timing:
    """Events of all curves of these kinds, and delays between those of groups."""
    curves = [*curves_of(performance), *articulator_curves(performance)]
    curves = [curve for curve in curves if curve.kind in kinds]
    courses = measured_courses(performance)
    events = []
    for i, curve in enumerate(curves):
        progress(0.9 * i / len(curves), f"fitting phases: {curve.name}")
        events += events_of(curve, performance, courses)
    progress(0.9, "delays between groups")
    groups = [event for event in events if event.curve.kind == "group"]
    return Timing(performance, curves, events, list(_delays(performance, groups)))


def events_of(
    curve: Curve, performance: Performance, courses: _core.MeasuredCourses | None = None
) -> list[Event]:
    """A curve's events in order; courses: what the pictures alone say, of muscles only."""
    is_by_pictures = courses is not None and curve.kind != "articulator"
    options = _phase_options(curve, is_by_pictures)
    options.scene_starts = _scene_starts(performance)
    fits = _core.fit_phases(
        *(performance.frame.astype(np.float64), curve.values, curve.stds),
        *((performance.quality >= HELD_QUALITY).tolist(), options),
        *((courses, curve.members) if is_by_pictures else ()),
    )
    return [Event(curve, number, fit) for number, fit in enumerate(fits, 1)]


def events_text(count: int) -> str:
    """So many events, in words."""
    return counted(count, "event")


def _scene_starts(performance: Performance) -> list[float]:
    """Frames at which scenes after the first begin."""
    return [float(performance.frame[scene.start]) for scene in performance.scenes[1:]]


def measured_courses(performance: Performance) -> _core.MeasuredCourses | None:
    """What the pictures alone say, where it is kept and a person has not corrected it."""
    if performance.evidence is None or performance.corrections:
        return None
    return _core.MeasuredCourses(performance.activations, performance.evidence)


def _phase_options(curve: Curve, by_pictures: bool) -> _core.PhaseOptions:
    options = _core.PhaseOptions()
    options.measured_std = curve.measured_std / curve.quickness
    options.shape_error = SHAPE_ERROR
    if by_pictures:
        options.robust_scale, options.exponent_std = PICTURES_ROBUST_SCALE, EXPONENT_STD
    return options


def curves_of(performance: Performance) -> Iterator[Curve]:
    """Groups, their sides, and muscles, in this order."""
    names = {
        ("group", name, group): performance.groups == group
        for group, name in GROUP_NAMES.items()
        if (performance.groups == group).any()
    }
    for group, name in GROUP_NAMES.items():
        for side in SIDES:
            is_of_side = np.array([muscle.endswith(side) for muscle in performance.muscles])
            is_member = (performance.groups == group) & is_of_side
            if is_member.any():
                names["side", f"{name}{side}", group] = is_member
    for i, (muscle, group) in enumerate(zip(performance.muscles, performance.groups, strict=True)):
        names["muscle", muscle, int(group)] = np.arange(len(performance.muscles)) == i
    members = np.array(list(names.values()), dtype=np.float64)
    means = _core.mean_curves(performance.activations, performance.activations_std, members)
    for i, (kind, name, group) in enumerate(names):
        values, stds = means.values[:, i].copy(), means.stds[:, i].copy()
        yield Curve(kind, name, group, values, stds, float(means.measured_std[i]), members[i])


def articulator_curves(performance: Performance) -> Iterator[Curve]:
    """Those of `COURSES` whose articulators the performance has."""
    for course, name in COURSES.items():
        articulator = course.removeprefix("-")
        columns = [
            i
            for i, other in enumerate(performance.articulators)
            if other.removesuffix(".L").removesuffix(".R") == articulator
        ]
        if not columns:
            continue
        values = performance.articulator_values[:, columns]
        stds = performance.articulator_values_std
        stds = np.zeros_like(values) if stds is None else stds[:, columns]
        means = _core.mean_curves(values, stds, np.ones((1, len(columns))))
        # Beyond rest alone: else a lid at rest between two blinks would have been raised
        beyond = np.maximum(0.0, means.values[:, 0] * (-1 if course.startswith("-") else 1))
        quickness = QUICKNESS.get(articulator, 1.0) * ARTICULATOR_STD[articulator] / ACTIVATION_STD
        none = np.zeros(len(performance.muscles))
        yield Curve(
            *("articulator", name, 0, beyond, means.stds[:, 0].copy()),
            *(float(means.measured_std[0]), none, quickness),
        )


def _delays(performance: Performance, events: list[Event]) -> Iterator[GroupDelay]:
    frames = performance.frame.astype(np.float64)
    options = _core.DelayOptions()
    options.scene_starts = _scene_starts(performance)
    for leader, follower in combinations(events, 2):
        if leader.curve is follower.curve:
            continue
        delay = _core.estimate_delay(
            frames, leader.curve.values, leader.fit, follower.curve.values, follower.fit, options
        )
        if delay is not None:
            yield GroupDelay(leader, follower, delay)
