# SPDX-License-Identifier: GPL-3.0-or-later
"""How few keys stand for the curves of real clips: `mimetic evaluate keys`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from mimetic.character.sparse_curves import USUAL_TOLERANCE, count_keys
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table

from evaluation.runs.real_captures import captured, kept_clips

WAYS = {"general": False, "by phases": True}
FEW_IN_EVENT = 6


@dataclass(frozen=True)
class KeyScore:
    clip: str
    way: str
    frames: int
    keys: int
    share: float  # of the dense keys
    error: float
    events: int  # by phases
    median_in_event: float
    few_in_event: float  # share of events with FEW_IN_EVENT keys or fewer


def score_keys(
    report: Callable[[str], None], folder: Path | None = None, last: int = 700
) -> Iterator[KeyScore]:
    """Each clip by each way; folder: performances, NAME.npz; without it clips are captured.

    last: the last frame that is captured.
    """
    for clip in kept_clips(folder):
        performance = captured(clip, last, report, folder)
        for way, by_phases in WAYS.items():
            count = count_keys(performance, USUAL_TOLERANCE, by_phases)
            of_event = np.array(count.keys_of_event or [np.nan])
            few = float((of_event <= FEW_IN_EVENT).mean()) if count.keys_of_event else np.nan
            yield KeyScore(
                *(clip, way, performance.num_frames, count.few, count.few / count.dense),
                *(count.error, len(count.keys_of_event), float(np.median(of_event)), few),
            )


def as_json(scores: list[KeyScore]) -> str:
    return json_text([asdict(score) for score in scores])


def as_text(scores: list[KeyScore]) -> str:
    columns = {
        "frames": ("frames", ".0f"),
        "keys": ("keys", ".0f"),
        "share": ("of the dense", ".1%"),
        "error": ("largest error", ".4f"),
        "events": ("events", ".0f"),
        "median_in_event": ("keys an event", ".0f"),
        "few_in_event": ("6 or fewer", ".0%"),
    }
    rows = {f"{score.clip}, {score.way}": asdict(score) for score in scores}
    figures = {name: {key: row[key] for key in columns} for name, row in rows.items()}
    return text_table(f"keys within {USUAL_TOLERANCE:g}", columns, figures)
