# SPDX-License-Identifier: GPL-3.0-or-later
"""An expression of a performance beside the action unit that FACS describes it by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.analyse.timing import (
    COURSES,
    Event,
    Timing,
    articulator_curves,
    events_of,
    events_text,
)
from mimetic.muscles.action_units import ActionUnit, action_unit, is_face, named_places
from mimetic.performance.document import Performance
from mimetic.template.face_template import FaceTemplate

SIGNIFICANT = 2.0  # standard deviations
AT_REST = 0.2  # of an event's height: what more is left in its last row would not be measured


@dataclass(frozen=True)
class PlaceMotion:
    """Motion at one of the places that the paper's text names; millimetres at the peak."""

    place: str
    seen: float
    unit: float
    std: float
    is_in_reach: bool  # of the action unit

    @property
    def verdict(self) -> str:
        """Whether motion is there that the unit lacks: yes, no or not decidable."""
        margin = SIGNIFICANT * self.std
        if self.seen - self.unit > margin:
            return "yes"
        is_less = self.unit - self.seen > margin
        is_still = self.seen < margin and self.std < 0.5
        return "no" if is_less or is_still else "not decidable"


@dataclass(frozen=True)
class Comparison:
    """One event of a performance beside an action unit. N frames of the event, V vertices."""

    performance: Performance
    event: Event
    unit: ActionUnit
    rows: NDArray[np.int64]  # N, of the performance
    rest: int  # into rows: the first, or the last where the onset is not seen
    peak: int  # into rows
    displacements: NDArray[np.float64]  # N x V x 3, metres from `rest`
    areas: NDArray[np.float64]  # V, square metres, 0 off the face
    stds: NDArray[np.float64]  # V, metres, of the displacement at the peak
    spatial: _core.SpatialComparison
    temporal: _core.TemporalComparison  # of the last N rows; of its onset only where that is seen
    places: list[PlaceMotion]

    @property
    def seen(self) -> NDArray[np.float64]:
        """V x 3, metres, at the peak."""
        return self.displacements[self.peak]

    @property
    def is_onset_seen(self) -> bool:
        """Whether the event begins within its scene."""
        return not self.event.fit.begins_before

    @property
    def course(self) -> NDArray[np.float64]:
        """N, 1 at most: the one curve that explains most."""
        return self.temporal.course[-len(self.rows) :]

    @property
    def ramp(self) -> NDArray[np.float64]:
        """N: the best straight up, hold, straight down for that curve."""
        return self.temporal.ramp[-len(self.rows) :]

    @property
    def by_unit(self) -> NDArray[np.float64]:
        """V x 3, metres: the unit at the intensity that explains most of its own region."""
        return self.spatial.intensity * self.unit.mode


def compare(
    timing: Timing,
    unit_name: str,
    template: FaceTemplate,
    number: int | None = None,
    only_certain: bool = True,
) -> Comparison:
    """An event of the unit's muscle group, or of the articulators that do it, beside the unit.

    number: which of these events, counted from 1; None takes the strongest that begins
    within the clip, of those that are certain unless only_certain is false. One that is there when
    its scene begins is measured from where it is released. Raises InvalidInput where there is none,
    or none of it is at rest, or on another mesh than the canonical.
    """
    performance = timing.performance
    neutral = performance.neutral_vertices
    unit = action_unit(unit_name, neutral, template)
    event, rest = _event_of(timing, unit, number, only_certain)
    rows = np.arange(event.fit.first, event.fit.last + 1)
    rest -= event.fit.first
    surfaces = np.stack([performance.surface(int(i)) for i in rows])
    displacements = surfaces - surfaces[rest]
    values = event.curve.values[rows]
    peak = int(values.argmax())
    areas = _core.skin_areas(neutral, template.faces, is_face(template))
    stds = displacement_std(performance, int(rows[peak]))
    motion = displacements[peak]
    spatial = _core.compare_displacements(neutral, motion, unit.mode, areas, stds, unit.reach)
    places = named_places(neutral, template)
    return Comparison(
        *(performance, event, unit, rows, rest, peak, displacements, areas, stds, spatial),
        _courses(performance.frame[rows], event, displacements, areas),
        _place_motions(motion, spatial.intensity, unit, stds, places),
    )


def displacement_std(performance: Performance, i: int) -> NDArray[np.float64]:
    """V, metres: of the surface at frame index `i`, by muscles, articulators and detail."""
    modes = [performance.muscle_modes]
    stds = [performance.activations_std[i]]
    if performance.articulator_modes is not None and performance.articulator_values_std is not None:
        modes.append(performance.articulator_modes)
        stds.append(performance.articulator_values_std[i])
    if performance.detail_modes is not None and performance.detail_coefficients_std is not None:
        modes.append(performance.detail_modes)
        stds.append(performance.detail_coefficients_std[i])
    all_modes = np.concatenate(modes).astype(np.float64)
    return _core.displacement_std(all_modes, np.concatenate(stds))


def rest_row(event: Event) -> int | None:
    """The row of the performance from which an event's motion is measured; None without any.

    Its first; its last where it is there already when its scene begins, and released in it.
    """
    fit, values = event.fit, event.curve.values
    if not fit.begins_before:
        return fit.first
    lowest, highest = values.min(), values[fit.first : fit.last + 1].max()
    is_released = values[fit.last] - lowest <= AT_REST * (highest - lowest)
    return fit.last if is_released and not fit.ends_after else None


def _event_of(
    timing: Timing, unit: ActionUnit, number: int | None, only_certain: bool
) -> tuple[Event, int]:
    """An event, and the row that it is measured from."""
    of_what, events = _events_of(timing, unit)
    rests = {event.number: rest_row(event) for event in events}
    if number is not None:
        matches = [event for event in events if event.number == number]
        if not matches:
            raise InvalidInput(
                f"--event {number}: {of_what} has {events_text(len(events))} (phases.csv of "
                "`mimetic analyse` lists them)"
            )
        rest = rests[number]
        if rest is None:
            first, last = (
                timing.performance.frame[row] for row in (matches[0].fit.first, matches[0].fit.last)
            )
            raise InvalidInput(
                f"--event {number}: it is there already in its first frame {first} and still in "
                f"its last, {last}, so that there is no rest to measure it from; capture frames "
                "before it begins, or until it is released"
            )
        return matches[0], rest
    whole = [
        event
        for event in events
        if (event.fit.is_certain or not only_certain) and not event.fit.begins_before
    ]
    if not whole:
        numbers = ", ".join(str(number) for number, rest in rests.items() if rest is not None)
        advice = f", or name one by --event ({numbers})" if numbers else ""
        raise InvalidInput(
            f"{of_what}, which is what {unit.name} does ({unit.meaning}), has no event that is "
            f"certain and begins within the clip; capture more of it{advice}"
        )
    strongest = max(whole, key=lambda event: event.fit.shape.amplitude)
    return strongest, strongest.fit.first


def _events_of(timing: Timing, unit: ActionUnit) -> tuple[str, list[Event]]:
    """Of what does what the unit does: what it is called, and its events."""
    if not unit.course:
        return f"group {unit.group}", timing.of_group(unit.group)
    name, performance = COURSES[unit.course], timing.performance
    curves = [curve for curve in articulator_curves(performance) if curve.name == name]
    return f"the {name}", [event for curve in curves for event in events_of(curve, performance)]


def _courses(
    frame: NDArray[np.int64],
    event: Event,
    displacements: NDArray[np.float64],
    areas: NDArray[np.float64],
) -> _core.TemporalComparison:
    """frame: N, of the event; displacements: N x V x 3, metres from rest."""
    frames = frame.astype(np.float64)
    if event.fit.begins_before:  # without a row at rest before it no ramp starts at its height
        frames = np.insert(frames, 0, frames[0] - 1)
        displacements = np.insert(displacements, 0, 0, axis=0)
    begin, apex = np.searchsorted(frames, (event.fit.shape.onset, event.fit.shape.apex))
    begin = int(np.clip(begin, 0, len(frames) - 2))
    apex = int(np.clip(apex, begin + 1, len(frames) - 1))
    return _core.compare_courses(np.ascontiguousarray(displacements), areas, begin, apex)


def _place_motions(
    motion: NDArray[np.float64],
    intensity: float,
    unit: ActionUnit,
    stds: NDArray[np.float64],
    places: dict[str, NDArray[np.float64]],
) -> list[PlaceMotion]:
    motions = []
    for place, weights in places.items():
        share = weights / max(1e-12, float(weights.sum()))
        lengths = [np.sqrt((field**2).sum(axis=1)) for field in (motion, intensity * unit.mode)]
        in_video, by_unit, std = (float(1000 * share @ values) for values in (*lengths, stds))
        is_in_reach = bool((unit.reach[weights > 0] > 0).any())
        motions.append(PlaceMotion(place, in_video, by_unit, std, is_in_reach))
    return motions
