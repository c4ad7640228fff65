# SPDX-License-Identifier: GPL-3.0-or-later
"""Blinks and contacts of lips in a capture, beside the ranges marked by hand."""

from __future__ import annotations

import csv
from dataclasses import dataclass, replace

import numpy as np
from mimetic import InvalidInput
from mimetic.performance.document import Performance
from numpy.typing import NDArray

from evaluation.runs.real_labels import FOLDER, POINTS, Labels
from evaluation.runs.real_methods import by_capture
from evaluation.runs.real_score import APART, lips_gap

SHUT = 0.6  # of both upper lids' way, on the mean: more than half closed lids of a squint
ACTIVE, SATURATED = 0.1, 0.98  # of an activation
NEAR = 1  # frames by which an event may miss its mark


@dataclass(frozen=True)
class Events:
    """One kind of event: how many were marked, how many of these found, and the false alarms."""

    clip: str
    kind: str
    marked: int
    hits: int
    false: int
    minutes: float

    @property
    def f1(self) -> float:
        return 2 * self.hits / max(1, self.marked + self.hits + self.false)

    def text(self) -> str:
        return (
            f"{self.clip}: {self.kind}: F1 {self.f1:.2f}; {self.hits} of {self.marked} found, "
            f"{self.false} where none is, {self.false / max(self.minutes, 1e-9):.1f} a minute"
        )


Range = tuple[int, int]


def score_events(clip: str, performance: Performance) -> list[Events]:
    """Blinks, and lips that touch, of a clip that has such ranges; within the captured frames."""
    events = []
    minutes = len(performance.frame) / float(performance.fps) / 60
    if (rows := _rows(f"{clip}.blinks.csv", performance)) is not None:
        candidates = runs(performance.frame, eyes_shut(performance))
        # A blink in which the capture ends or begins is neither to be found nor wrong if it is
        cut = _shut(_rows(f"{clip}.blinks.csv", performance, cut=True) or [])
        candidates = [run for run in candidates if not any(_meet(run, one) for one in cut)]
        events.append(_matched(clip, "blinks", _shut(rows), candidates, minutes))
    if (rows := _rows(f"{clip}.lips.csv", performance)) is not None:
        events.append(_lips_told(clip, rows, performance, minutes))
    return events


def _shut(rows: list[dict[str, str]]) -> list[Range]:
    return [
        (int(row["closed_first"]), int(row["closed_last"]))
        for row in rows
        if row["kind"] in ("blink", "closed")
    ]


def eyes_shut(performance: Performance) -> NDArray[np.bool_]:
    names = list(performance.articulators)
    lids = performance.articulator_values[:, [names.index(f"lid_upper.{s}") for s in "LR"]]
    return lids.mean(axis=1) >= SHUT


def lips_touch(performance: Performance) -> NDArray[np.bool_]:
    """N: whether the inner lips meet on the midline, as it is marked in real frames."""
    unmarked = np.full((performance.num_frames, len(POINTS), 2), np.nan)
    frames = Labels("", performance.frame, unmarked, unmarked[:, 0, 0])
    places = by_capture(frames, performance)
    return lips_gap(replace(frames, places=places), places) < APART


def saturation(performance: Performance) -> float:
    """Share of the active muscle-frames in which the muscle is as good as at its bound."""
    is_active = performance.activations > ACTIVE
    return float((performance.activations > SATURATED).sum() / max(1, is_active.sum()))


def runs(frames: NDArray[np.int64], holds: NDArray[np.bool_]) -> list[Range]:
    """First and last frames of the runs in which something holds."""
    edges = np.flatnonzero(np.diff(np.r_[False, holds, False]))
    return [(int(frames[a]), int(frames[b - 1])) for a, b in edges.reshape(-1, 2)]


def _meet(a: Range, b: Range) -> bool:
    return a[0] <= b[1] + NEAR and b[0] <= a[1] + NEAR


def _matched(
    clip: str, kind: str, marks: list[Range], candidates: list[Range], minutes: float
) -> Events:
    """Counts the marked events that overlap a candidate, and candidates that overlap none.

    Overlap allows for NEAR frames at either end."""

    hits = sum(any(_meet(one, run) for run in candidates) for one in marks)
    false = sum(not any(_meet(one, run) for one in marks) for run in candidates)
    return Events(clip, kind, len(marks), hits, false, minutes)


def _lips_told(
    clip: str, rows: list[dict[str, str]], performance: Performance, minutes: float
) -> Events:
    """Ranges in which lips touch: found where they do so in most of their frames."""
    touch = lips_touch(performance)
    counts = {"touch": 0, "hits": 0, "false": 0}
    for row in rows:
        inside = (performance.frame >= int(row["first"])) & (performance.frame <= int(row["last"]))
        most = bool(touch[inside].mean() > 0.5)
        if row["lips"] == "touch":
            counts["touch"] += 1
            counts["hits"] += most
        else:
            counts["false"] += most
    return Events(
        clip, "lips that touch", counts["touch"], counts["hits"], counts["false"], minutes
    )


def _rows(name: str, performance: Performance, cut: bool = False) -> list[dict[str, str]] | None:
    """Of a table of ranges, those within the captured frames, or those that reach out of them;
    None without such a table."""
    path = FOLDER / name
    if not path.exists():
        return None
    first, last = int(performance.frame[0]), int(performance.frame[-1])
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    try:
        ends = [(int(r.get("start") or r["first"]), int(r.get("end") or r["last"])) for r in rows]
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{path}: {error}; evaluation/real/README.md has the columns") from None
    if cut:
        is_kept = [(a < first <= b) or (a <= last < b) for a, b in ends]
    else:
        is_kept = [first <= a and b <= last for a, b in ends]
    return [row for row, kept in zip(rows, is_kept, strict=True) if kept]
