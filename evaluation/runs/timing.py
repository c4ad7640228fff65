# SPDX-License-Identifier: GPL-3.0-or-later
"""When muscles fire, on clips that fire them at known moments: `mimetic evaluate timing`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from mimetic.analyse.timing import Event, Timing, analyse_timing
from mimetic.performance.document import Performance
from mimetic.score.json_text import json_text
from mimetic.score.truth import Truth
from mimetic.template.face_template import load_template

from evaluation.runs.kept_captures import KeptCaptures, Report
from evaluation.runs.timing_curves import curve_rows
from evaluation.runs.timing_outside import OutsideShare, outside_rows, outside_shares
from evaluation.runs.timing_units import UnitClip, score_units, unit_rows
from evaluation.synthetic.timing.films import timing_clip
from evaluation.synthetic.timing.firing import Firing
from evaluation.synthetic.timing.recipes import DELAY, EXPRESSIONS, GROUPS, SETS, TimedClip

NEAR = 15  # frames about the true onset in which an event belongs to it


@dataclass(frozen=True)
class GroupEvent:
    """One true event of a group, and its estimate. Frames, counted from 1."""

    clip: str
    condition: str
    expression: str
    group: int
    onset: float
    exponent: float
    was_seen: bool
    onset_error: float = math.nan
    onset_held: bool = False  # by its own 95 % interval
    release_error: float = math.nan
    exponent_error: float = math.nan
    exponent_held: bool = False
    model: str = ""
    # of the middle of the application, at half its height: what delays depend on
    half_error: float = math.nan
    amplitude: float = math.nan  # true, of the mean of the group's muscles
    amplitude_error: float = math.nan
    amplitude_held: bool = False


@dataclass(frozen=True)
class PairEvent:
    """Two groups of one expression: the true delay, none for a silent second group."""

    clip: str
    condition: str
    expression: str
    delay: float | None
    was_measured: bool
    error: float = math.nan
    held: bool = False
    is_delayed: bool = False


@dataclass
class TimingScores:
    groups: list[GroupEvent] = field(default_factory=list)
    pairs: list[PairEvent] = field(default_factory=list)
    silent_events: int = 0  # certain events of a group that truth leaves silent
    silent_chances: int = 0  # expressions in which it might have had one
    units: list[UnitClip] = field(default_factory=list)  # of clips that move by FACS alone
    outside: list[OutsideShare] = field(default_factory=list)  # of the others: what FACS lacks


def score_timing(
    which: str, report: Report, out: Path | None = None, folder: Path | None = None
) -> TimingScores:
    """Renders, captures and analyses the clips of a set.

    out: a folder in which the captured performances are kept. folder: such a one of an earlier run:
    clips that are in it are analysed again without capturing them.
    """
    scores = TimingScores()
    kept = KeptCaptures(out, folder, report)
    template = load_template()
    for clip, timing in _analysed(which, kept):
        truth = Truth.load(timing_clip(clip.recipe, template, report).truth)
        _score_clip(clip, timing, truth, scores)
        scores.outside += outside_shares(clip.recipe.name, timing, truth, template)
    scores.units = score_units(which, kept)
    return scores


def _analysed(which: str, kept: KeptCaptures) -> Iterator[tuple[TimedClip, Timing]]:
    template = load_template()
    for clip in SETS[which]:
        name = clip.recipe.name
        performance = kept.of(name, partial(timing_clip, clip.recipe, template, kept.report))
        yield clip, analyse_timing(performance, kinds=("group",))


def _score_clip(clip: TimedClip, timing: Timing, truth: Truth, scores: TimingScores) -> None:
    for expression, groups in GROUPS.items():
        truths = [_truth_of(clip, expression, part) for part in (0, 1)]
        events = [
            _nearest(timing, group, firing or truths[0])
            for group, firing in zip(groups, truths, strict=True)
        ]
        name = clip.recipe.name
        for group, firing, event in zip(groups, truths, events, strict=True):
            if firing is not None:
                amplitude = _true_amplitude(truth, timing.performance, group, firing)
                scores.groups.append(
                    _group_event(clip, expression, group, firing, event, amplitude)
                )
        if truths[1] is None:
            scores.silent_chances += 1
            scores.silent_events += events[1] is not None
        pair = next(
            (
                pair.delay
                for pair in timing.delays
                if {pair.leader.curve.group, pair.follower.curve.group} == set(groups)
                and any(pair.leader is e or pair.follower is e for e in events if e)
                and abs(_mean_onset(pair) - _onset(truths[0])) < NEAR
            ),
            None,
        )
        sign = 1 if groups[0] < groups[1] else -1
        scores.pairs.append(_pair_event(name, clip.condition, expression, truths, pair, sign))


def _mean_onset(pair) -> float:
    return (pair.leader.fit.shape.onset + pair.follower.fit.shape.onset) / 2


def _truth_of(clip: TimedClip, expression: str, part: int) -> Firing | None:
    """How the first muscle of the expression's group fires, if it does."""
    names = EXPRESSIONS[expression][part]
    firings = (phase for phase in clip.recipe.phases if phase.control.split(".")[0] in names)
    return next(firings, None)


def _onset(truth: Firing) -> float:
    return 1 + 30 * truth.start


def _true_amplitude(truth: Truth, performance: Performance, group: int, firing: Firing) -> float:
    """Of the mean of a group's muscles, in the performance's unit, while they fire."""
    columns = [truth.muscles.index(name) for name in performance.muscles]
    extent = performance.muscle_extent
    values = truth.activations[:, columns] / (1 if extent is None else extent)
    first = int(_onset(firing)) - 1
    last = first + int(30 * (firing.rise + firing.hold)) + 1
    return float(values[first:last, performance.groups == group].mean(axis=1).max())


def _nearest(timing: Timing, group: int, truth: Firing) -> Event | None:
    near = [
        event
        for event in timing.of_group(group)
        if event.fit.is_certain and abs(event.fit.shape.onset - _onset(truth)) < NEAR
    ]
    return max(near, key=lambda event: event.fit.shape.amplitude, default=None)


def _group_event(
    clip: TimedClip,
    expression: str,
    group: int,
    truth: Firing,
    event: Event | None,
    amplitude: float,
) -> GroupEvent:
    onset, release = _onset(truth), _onset(truth) + 30 * (truth.rise + truth.hold)
    key = (clip.recipe.name, clip.condition, expression, group, onset, truth.exponent)
    if event is None:
        return GroupEvent(*key, False)
    fit = event.fit
    return GroupEvent(
        *(*key, True),
        fit.onset.value - onset,
        fit.onset.lower <= onset <= fit.onset.upper,
        fit.release.value - release,
        fit.exponent.value - truth.exponent,
        fit.exponent.lower <= truth.exponent <= fit.exponent.upper,
        fit.shape.model.name,
        _half_of(fit.shape.onset, fit.shape.rise, fit.shape.exponent)
        - _half_of(onset, 30 * truth.rise, truth.exponent),
        amplitude,
        event.amplitude.value - amplitude,
        event.amplitude.lower <= amplitude <= event.amplitude.upper,
    )


def _half_of(onset: float, rise: float, exponent: float) -> float:
    """The frame at which half the application is done."""
    if abs(exponent) < 1e-4:
        return onset + rise / 2
    return onset + rise * math.log(1 + math.expm1(exponent) / 2) / exponent


def _pair_event(name, condition, expression, truths, delay, sign) -> PairEvent:
    late = None if truths[1] is None else float(DELAY if condition == "delayed" else 0)
    if delay is None:
        return PairEvent(name, condition, expression, late, False)
    if late is None:
        return PairEvent(name, condition, expression, None, True, is_delayed=delay.is_delayed)
    lag = delay.lag
    true = sign * late
    return PairEvent(
        *(name, condition, expression, late, True),
        lag.value - true,
        lag.lower <= true <= lag.upper,
        delay.is_delayed,
    )


def as_json(scores: TimingScores) -> str:
    return json_text(asdict(scores))


def as_text(scores: TimingScores) -> str:
    detections = [event for event in scores.groups if event.was_seen]
    pairs = [pair for pair in scores.pairs if pair.was_measured and pair.delay is not None]
    late = [pair for pair in pairs if pair.delay]
    together = [pair for pair in scores.pairs if pair.delay == 0]
    silent = [pair for pair in scores.pairs if pair.delay is None]
    false = sum(pair.is_delayed for pair in (*together, *silent))
    rows = [
        ["events of groups that were found", f"{len(detections)} of {len(scores.groups)}"],
        ["onset, median error, frames", _median([e.onset_error for e in detections])],
        ["  95th percentile", _percentile([e.onset_error for e in detections], 95)],
        ["  95 % intervals that hold it", _share([e.onset_held for e in detections])],
        [
            "half of the application, median error, frames",
            _median([e.half_error for e in detections]),
        ],
        ["release, median error, frames", _median([e.release_error for e in detections])],
        [
            "exponent, median error as a share of the truth",
            _median([e.exponent_error / e.exponent for e in detections]),
        ],
        ["  95 % intervals that hold it", _share([e.exponent_held for e in detections])],
        [
            "amplitude of a group, median error as a share of the truth",
            _median([e.amplitude_error / e.amplitude for e in detections]),
        ],
        ["  95 % intervals that hold it", _share([e.amplitude_held for e in detections])],
        ["delay, median error, frames", _median([p.error for p in pairs])],
        ["  largest", _percentile([p.error for p in pairs], 100)],
        ["  of those that are 3 frames late", _median([p.error for p in late])],
        ["  95 % intervals that hold it", _share([p.held for p in pairs])],
        ["delays of 3 frames that are reported", _share([p.is_delayed for p in late])],
        [
            "delays reported where there is none",
            f"{false} of {len(together) + len(silent)} ({len(silent)} with a silent group)",
        ],
        [
            "events reported of a silent group",
            f"{scores.silent_events} of {scores.silent_chances}",
        ],
    ]
    models = sorted({event.model for event in detections})
    counts = ", ".join(f"{sum(e.model == m for e in detections)} {m}" for m in models)
    alone = curve_rows()
    units = [*unit_rows(scores.units), *outside_rows(scores.outside)]
    width = max(len(name) for name, _ in rows) + 2
    lines = [f"{name.ljust(width)}{value}" for name, value in rows]
    lines += ["", f"models chosen: {counts}", ""]
    lines += [*(f"{name.ljust(width)}{value}" for name, value in units), ""]
    lines.append("curves alone, median errors")
    return "\n".join([*lines, *(f"{name.ljust(width)}{value}" for name, value in alone)])


def _median(errors: list[float]) -> str:
    return f"{np.median(np.abs(errors)):.2f}" if errors else "-"


def _percentile(errors: list[float], percent: float) -> str:
    return f"{np.percentile(np.abs(errors), percent):.2f}" if errors else "-"


def _share(flags: list[bool]) -> str:
    return f"{sum(flags)} of {len(flags)}" if flags else "-"
