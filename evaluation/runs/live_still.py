# SPDX-License-Identifier: GPL-3.0-or-later
"""Part of `mimetic evaluate live`: what moves in a rendered face that is at rest all the time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mimetic.media.footage import Footage
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.take import Take
from mimetic.score.text_table import text_table
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.runs.live import STILLNESSES, stilled
from evaluation.runs.real_still import RUN, jitter
from evaluation.synthetic.clips import clip
from evaluation.synthetic.recipes import HELD_OUT

Report = Callable[[str], None]
ROUNDS = 6  # that the clip is played, there and back; the head is known after four seconds
SETTLED = 5.0  # seconds


@dataclass(frozen=True)
class StillScore:
    """One clip, one way; of values whose truth is 0.

    jitter, lids: about a steady motion, as `live_score.jitter_at_rest` has it, of muscles and of
    jaw, lids and lips; wander: standard deviation of the muscles over all the time; off: the
    muscles' mean, root mean square; most: the largest activation.
    """

    clip: str
    way: str
    jitter: float
    lids: float
    wander: float
    off: float
    most: float


def score_still(report: Report) -> list[StillScore]:
    """Of the held-out clip in which nothing but the head moves, by a millimetre."""
    scores = []
    for recipe in HELD_OUT:
        if recipe.kind != "still":
            continue
        footage = Footage(clip(recipe, load_template(), report).footage)
        report(f"{recipe.name}: live")
        take = _played(footage)
        for stillness in STILLNESSES:
            scores.append(_score(recipe.name, stillness, stilled(take, stillness)))
    return scores


def _played(footage: Footage) -> Take:
    images = [np.array(image) for _, image in footage.frames()]
    there_and_back = [*images, *images[-2:0:-1]]
    live, take, fps = LiveFilter(0.0, in_background=False), Take(float(footage.fps)), footage.fps
    for number, image in enumerate(ROUNDS * there_and_back):
        state = live.advance(image, number / float(fps))
        if state is not None and live.face is not None:
            take.add(state, live.face)
    return take


def _score(name: str, stillness: float, take: Take) -> StillScore:
    performance = take.performance()
    first = round(SETTLED * performance.fps)
    values = performance.activations[first:]
    is_skins = [not name.startswith("gaze") for name in performance.articulators]
    return StillScore(
        *(name, f"live, stillness {stillness:g}"),
        *(_jitter(values), _jitter(performance.articulator_values[first:, is_skins])),
        float(np.sqrt(values.var(axis=0).mean())),
        float(np.sqrt((values.mean(axis=0) ** 2).mean())),
        float(values.max()),
    )


def _jitter(values: NDArray[np.float64]) -> float:
    """Of columns, in runs of RUN rows: root mean square, the median of the runs."""
    runs = values[: len(values) // RUN * RUN].reshape(-1, RUN, values.shape[1])
    variance = jitter(runs[..., None])[..., 0]
    return float(np.sqrt(np.median(variance.mean(axis=1))))


def as_text(scores: list[StillScore]) -> str:
    columns = {
        "jitter": ("jitter at rest", ".4f"),
        "lids": ("jaw, lids", ".4f"),
        "wander": ("s.d. in all", ".4f"),
        "off": ("mean, rms", ".4f"),
        "most": ("largest", ".4f"),
    }
    rows = {f"{score.clip}, {score.way}": vars(score) for score in scores}
    return text_table("a rendered face at rest", columns, rows, cell=12)
