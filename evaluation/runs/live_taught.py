# SPDX-License-Identifier: GPL-3.0-or-later
"""Part of `mimetic evaluate live`: what a taught set adds, on time that it was not taught from."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.live_filter import DEFAULT_STILLNESS
from mimetic.puppet.taught_follower import DRIVE, SHARPEN
from mimetic.puppet.teaching import teach
from mimetic.score.text_table import text_table

from evaluation.runs.live import followed, stilled
from evaluation.runs.live_score import (
    GROUPS,
    JAW,
    LIDS,
    common_rows,
    correlations,
    curves_of,
    jitter_at_rest,
)
from evaluation.runs.puppet import BLOCK, LAST, NUM_CHOSEN
from evaluation.runs.real_captures import captured, kept_clips
from evaluation.runs.real_labels import footage_of
from evaluation.runs.real_still import still_runs

ALONE = "live alone"
WAYS = {ALONE: None, "set sharpens": SHARPEN, "set drives": DRIVE}
Report = Callable[[str], None]


@dataclass(frozen=True)
class TaughtScore:
    """One clip, one way: in held-out time."""

    clip: str
    way: str
    correlation: dict[str, float]  # with the offline solve
    jitter: float


def score_taught(report: Report, folder: Path | None = None) -> Iterator[list[TaughtScore]]:
    """Clip by clip: from every other BLOCK seconds a set is taught, the rest is tried.

    folder: performances of the clips, NAME.npz; without it they are captured.
    """
    for clip in kept_clips(folder):
        offline = captured(clip, LAST, report, folder)
        block = (offline.frame - offline.frame[0]) // round(BLOCK * offline.fps)
        held_out = offline.frame[block % 2 == 1]
        if not len(held_out):
            continue  # too short to hold time out
        report(f"{clip}: teach, follow live with the set")
        yield _score_clip(clip, offline, held_out)


def _score_clip(clip: str, offline: Performance, held_out: np.ndarray) -> list[TaughtScore]:
    footage = Footage(footage_of(clip))
    taught = teach(footage, offline, [], NUM_CHOSEN, left_out=held_out.tolist())
    runs = still_runs(clip, offline)
    runs = runs[np.isin(runs, held_out).all(axis=1)]
    scores = []
    for way, use in WAYS.items():
        take = followed(footage, int(offline.frame[-1]), taught if use else None, use or SHARPEN)
        live = stilled(take, DEFAULT_STILLNESS).performance(footage)
        rows, offline_rows = common_rows(live, offline)
        is_tried = np.isin(live.frame[rows], held_out)
        of_live, truth = (
            curves_of(live, rows[is_tried]),
            curves_of(offline, offline_rows[is_tried]),
        )
        jitter = jitter_at_rest(runs, live) if len(runs) else float("nan")
        scores.append(TaughtScore(clip, way, correlations(of_live, truth), jitter))
    return scores


def as_text(scores: list[TaughtScore]) -> str:
    columns = {f"group {group}": (f"group {group}", ".2f") for group in GROUPS}
    columns |= {name: (name, ".2f") for name in (JAW, LIDS)}
    columns |= {"mean": ("mean", ".3f"), "jitter": ("jitter at rest", ".4f")}
    rows = {}
    for score in scores:
        shown = [score.correlation[name] for name in columns if name in score.correlation]
        figures = {"mean": float(np.nanmean(shown)), "jitter": score.jitter}
        rows[f"{score.clip}, {score.way}"] = score.correlation | figures
    return text_table("held-out time, with a taught set", columns, rows, cell=12)
