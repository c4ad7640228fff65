# SPDX-License-Identifier: GPL-3.0-or-later
"""The numbers of an analysis as CSV; an empty cell is what cannot be known."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping
from pathlib import Path

from mimetic import _core
from mimetic.analyse.estimate import Estimate
from mimetic.analyse.timing import Event, GroupDelay, Timing
from mimetic.shared.whole_file import whole_file

Row = Mapping[str, object]


def write_table(path: Path, rows: Iterable[Row], columns: list[str]) -> None:
    """A CSV with these columns, whole or not at all; raises OSError."""
    text = io.StringIO(newline="")
    table = csv.DictWriter(text, columns, restval="", lineterminator="\n")
    table.writeheader()
    table.writerows({name: _cell(value) for name, value in row.items()} for row in rows)
    with whole_file(path) as stream:
        stream.write(text.getvalue().encode())


def interval_cells(name: str, interval: _core.Interval | Estimate | None) -> dict[str, object]:
    """An estimate and the ends of its 95 % interval; empty cells where nothing is known."""
    values = (interval.value, interval.lower, interval.upper) if interval else ("", "", "")
    return dict(zip((name, f"{name}_lower", f"{name}_upper"), values, strict=True))


def phase_rows(timing: Timing) -> list[dict[str, object]]:
    return [_phase_row(event, timing.performance.fps) for event in timing.events]


def delay_rows(timing: Timing) -> list[dict[str, object]]:
    return [_delay_row(delay, timing.performance.fps) for delay in timing.delays]


def _phase_row(event: Event, fps: float) -> dict[str, object]:
    fit, shape = event.fit, event.fit.shape
    begins, ends = not fit.begins_before, not fit.ends_after
    two = shape.model == _core.PhaseModel.two_exponentials and ends
    is_curved = shape.model != _core.PhaseModel.linear_ramp
    return {
        "kind": event.curve.kind,
        "name": event.curve.name,
        "group": event.curve.group or "",
        "event": event.number,
        "is_certain": fit.is_certain,
        "model": shape.model.name,
        **interval_cells("onset_frame", fit.onset if begins else None),
        **interval_cells("apex_frame", fit.apex if begins else None),
        **interval_cells("release_frame", fit.release if ends else None),
        "rise_seconds": shape.rise / fps if begins else "",
        "hold_seconds": shape.hold / fps if begins and ends else "",
        **interval_cells("amplitude", event.amplitude),
        **interval_cells("exponent", fit.exponent if begins else None),
        **interval_cells("release_frames", fit.release_time if ends else None),
        **interval_cells("relaxation_frames", fit.relaxation_time if two else None),
        **interval_cells("relaxed_share", fit.relaxed_share if two else None),
        "noise": fit.noise,
        "r2": fit.explained,
        "linear_ramp_r2": fit.linear_explained,
        **{f"bic_{model}": fit.bic[i] for i, model in enumerate(_core.PhaseModel.__members__)},
        "release_is": "exponential" if is_curved else "straight",
        "begins_before_clip": fit.begins_before,
        "ends_after_clip": fit.ends_after,
    }


def _delay_row(pair: GroupDelay, fps: float) -> dict[str, object]:
    delay = pair.delay
    return {
        "leader": pair.leader.curve.name,
        "leader_group": pair.leader.curve.group,
        "leader_event": pair.leader.number,
        "follower": pair.follower.curve.name,
        "follower_group": pair.follower.curve.group,
        "follower_event": pair.follower.number,
        **interval_cells("delay_frames", delay.lag),
        "delay_seconds": delay.lag.value / fps,
        "is_delayed": delay.is_delayed,
        "correlation": delay.correlation,
        "chance": delay.chance,
        "onset_difference_frames": delay.onset_lag,
        "apex_difference_frames": delay.apex_lag,
    }


def columns_of(rows: list[dict[str, object]], empty: list[str]) -> list[str]:
    """The columns of rows, or those given where there are none."""
    return list(rows[0]) if rows else empty


def _cell(value: object) -> object:
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return f"{value:.6g}" if math.isfinite(value) else ""
    return value
