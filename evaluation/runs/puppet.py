# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate puppet`: taught faces on held-out time of real clips, and their tolerance."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.driver import Puppet
from mimetic.puppet.mapping import BASES, MODES, Mapping
from mimetic.puppet.seeing import PersonView
from mimetic.puppet.teaching import best_seen, known_poses, teach
from mimetic.score.json_text import json_text
from mimetic.score.scores import INTERVAL_90
from mimetic.score.text_table import text_table
from mimetic.shared.pinhole import camera_of
from numpy.typing import NDArray

from evaluation.runs.puppet_tolerance import Tolerance, score_tolerance
from evaluation.runs.real_captures import captured, kept_clips
from evaluation.runs.real_labels import footage_of

LAST = 600  # frame
NUM_CHOSEN = 12  # looks
BLOCK = 4.0  # seconds: taught from one, tried on the next
MOVES = 0.03  # least standard deviation, in taught and in held-out time, of a group that moves
SHUT, OPEN = 0.5, 0.3  # of the upper lids: a blink begins above the one and ends below the other


@dataclass(frozen=True)
class HeldOut:
    """Of one group of muscles, or of an articulator, in held-out time of a clip."""

    clip: str
    mode: str
    basis: str
    what: str
    spread: float  # standard deviation of what was captured
    correlation: float
    error: float  # rms
    inside: float  # share of muscle-frames within the 90 % interval


@dataclass(frozen=True)
class Blinks:
    clip: str
    mode: str
    basis: str
    captured: int
    caught: float  # share
    false_a_minute: float


def score_held_out(
    report: Callable[[str], None], folder: Path | None = None
) -> Iterator[HeldOut | Blinks]:
    """folder: performances of the clips, NAME.npz; without it they are captured."""
    for name in kept_clips(folder):
        performance = captured(name, LAST, report, folder)
        if performance.num_frames < 2 * _block_frames(performance):
            report(f"{name}: left out, shorter than {BLOCK:g} s taught and {BLOCK:g} s tried")
            continue
        report(f"{name}: teach, drive")
        yield from _score_clip(name, Footage(footage_of(name)), performance)


def _block_frames(performance: Performance) -> int:
    return round(BLOCK * performance.fps)


def _score_clip(
    name: str, footage: Footage, performance: Performance
) -> Iterator[HeldOut | Blinks]:
    block = (performance.frame - performance.frame[0]) // _block_frames(performance)
    is_held_out = block % 2 == 1
    left_out = performance.frame[is_held_out].tolist()
    taught = teach(footage, performance, [], NUM_CHOSEN, left_out=left_out)
    camera = camera_of(performance.intrinsics, performance.image_size)
    view = PersonView(camera, performance.neutral_vertices, taught.sides, taught.pixel)
    mappings = {(mode, basis): Mapping(taught, mode, basis) for mode in MODES for basis in BASES}
    puppet = Puppet(taught, view, *best_seen(footage, performance))
    known = known_poses(performance)
    is_lost = True
    frames: list[int] = []
    scores: list[NDArray[np.float64]] = []
    first, last = int(performance.frame[0]), int(performance.frame[-1])
    for frame, image in footage.frames(first, last):
        # A detector sees a lost head about where it was captured
        guess = known.get(frame) if is_lost else None
        seen = puppet.advance(np.ascontiguousarray(image), 1 / performance.fps, guess)
        is_lost = seen.held
        if not is_lost:
            frames.append(performance.index_of(frame))
            scores.append(seen.scores)
    rows = np.array(frames)
    for (mode, basis), mapping in mappings.items():
        states = [mapping.state(row) for row in scores]
        values = np.array([state.values for state in states])
        std = np.array([state.std for state in states])
        yield from _compare(name, mode, basis, performance, rows, is_held_out, values, std)


def _compare(
    name: str,
    mode: str,
    basis: str,
    performance: Performance,
    rows: NDArray[np.int64],
    is_held_out: NDArray[np.bool_],
    values: NDArray[np.float64],
    std: NDArray[np.float64],
) -> Iterator[HeldOut | Blinks]:
    captured = np.hstack([performance.activations, performance.articulator_values])[rows]
    tried = is_held_out[rows]
    names = [*performance.muscles, *performance.articulators]
    columns = {f"group {g}": np.flatnonzero(performance.groups == g) for g in range(1, 8)}
    columns |= {n: np.array([names.index(n)]) for n in ("jaw_open", "lid_upper.L") if n in names}
    for what, members in columns.items():
        truth, own = captured[:, members].mean(axis=1), values[:, members].mean(axis=1)
        if min(truth[tried].std(), truth[~tried].std()) < MOVES:
            continue
        correlation = np.corrcoef(truth[tried], own[tried])[0, 1] if own[tried].std() > 0 else 0
        off = np.abs(values - captured)[tried][:, members]
        yield HeldOut(
            *(name, mode, basis, what, float(truth[tried].std()), float(correlation)),
            float(np.sqrt(((truth - own)[tried] ** 2).mean())),
            float((off <= INTERVAL_90 * std[tried][:, members]).mean()),
        )
    lids = [names.index(f"lid_upper.{side}") for side in "LR"]
    events = [_blinks(np.where(tried, one[:, lids].mean(axis=1), 0)) for one in (captured, values)]
    caught = sum(any(a[0] <= b[1] + 2 and b[0] <= a[1] + 2 for b in events[1]) for a in events[0])
    false = sum(all(a[0] > b[1] + 2 or b[0] > a[1] + 2 for b in events[0]) for a in events[1])
    minutes = tried.sum() / performance.fps / 60
    share = caught / len(events[0]) if events[0] else float("nan")
    yield Blinks(name, mode, basis, len(events[0]), share, false / minutes)


def _blinks(closure: NDArray[np.float64]) -> list[tuple[int, int]]:
    """First and last row of each blink."""
    events: list[tuple[int, int]] = []
    start: int | None = None
    for i, value in enumerate(closure):
        if start is None and value > SHUT:
            start = i
        elif start is not None and value < OPEN:
            events.append((start, i))
            start = None
    return events


Scores = list[HeldOut | Blinks | Tolerance]


def score_puppet(report: Callable[[str], None], folder: Path | None = None) -> Scores:
    return [*score_held_out(report, folder), *score_tolerance(report)]


def as_json(scores: Scores) -> str:
    return json_text([{"table": type(one).__name__, **asdict(one)} for one in scores])


def as_text(scores: Scores) -> str:
    held_out = [one for one in scores if isinstance(one, HeldOut)]
    blinks = [one for one in scores if isinstance(one, Blinks)]
    tolerance = [one for one in scores if isinstance(one, Tolerance)]
    tables = []
    if held_out:
        columns = {
            "spread": ("captured s.d.", ".3f"),
            "correlation": ("correlation", ".2f"),
            "error": ("rms error", ".3f"),
            "inside": ("in 90 % bars", ".2f"),
        }
        rows = {f"{s.clip}, {s.mode}, {s.basis}, {s.what}": _figures(s) for s in held_out}
        tables.append(text_table("held-out time", columns, rows))
    if blinks:
        columns = {
            "captured": ("captured", ".0f"),
            "caught": ("caught", ".0%"),
            "false_a_minute": ("false a minute", ".1f"),
        }
        rows = {f"{s.clip}, {s.mode}, {s.basis}": _figures(s) for s in blinks}
        tables.append(text_table("blinks in held-out time", columns, rows))
    if tolerance:
        columns = {"error": ("rms error", ".3f"), "grown": ("grown by", ".3f")}
        rows = {f"{s.clip}, head: {s.head}, {s.kind} {s.amount:g}": _figures(s) for s in tolerance}
        tables.append(text_table("disturbed pictures", columns, rows))
    if tolerance:
        tables.append(_within(tolerance))
    return "\n\n".join(tables)


def _within(tolerance: list[Tolerance]) -> str:
    rows = {}
    for head in dict.fromkeys(score.head for score in tolerance):
        own = [score.grown for score in tolerance if score.head == head and score.inside]
        rows[f"head: {head}"] = {"most": max(own), "median": float(np.median(own))}
    columns = {"median": ("median", ".3f"), "most": ("most", ".3f")}
    return text_table("growth within the paper's limits", columns, rows)


def _figures(score: HeldOut | Blinks | Tolerance) -> dict[str, float]:
    return {key: value for key, value in asdict(score).items() if isinstance(value, (int, float))}
