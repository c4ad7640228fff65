# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate real`: eyes and lips of real faces beside points that were marked by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from mimetic.locate.feature_networks import installed_networks
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from numpy.typing import NDArray

from evaluation.runs.head_clips import face_mesh_python
from evaluation.runs.real_captures import captured, kept_clips
from evaluation.runs.real_events import saturation, score_events
from evaluation.runs.real_labels import CLIPS, Labels, footage_of, read_labels
from evaluation.runs.real_methods import (
    by_capture,
    by_face_mesh,
    by_fit,
    by_networks,
    by_regressor,
    networks_alone,
)
from evaluation.runs.real_noise import SHRUNK, Sightings, sightings
from evaluation.runs.real_photographs import faces_texts, read_images, score_photographs
from evaluation.runs.real_score import (
    AGAIN,
    FACE_MESH,
    FEATURES,
    FIRST_FIT,
    RealScore,
    score_again,
    score_places,
)
from evaluation.runs.real_still import crops_of, in_crops, jitter, still_runs, with_frames

OURS, NETWORKS, JOINED = "capture", "its networks, our crops", "with our regressor"
REGRESSOR = "our regressor alone"
CELL = 14
Report = Callable[[str], None]


def score_real(
    report: Report, out: Path | None = None, folder: Path | None = None
) -> Iterator[tuple[list[RealScore], list[Sightings]]]:
    """Clip by clip: every method's, and what the networks say there. Raises InvalidInput.

    out: a folder in which the captured performances are kept. folder: such a one of
    an earlier run; only the clips and frames in it are scored.
    """
    clips = kept_clips(folder)
    for clip in clips:
        footage_of(clip)  # raises before minutes of work on the first
    python = face_mesh_python(report)
    for clip in clips:
        labels = read_labels(clip)
        performance = captured(clip, int(labels.frame[-1]), report, folder)
        labels = labels.rows(np.isin(labels.frame, performance.frame))
        if out is not None:
            performance.save(out / f"{clip}.npz")
        yield score_clip(labels, performance, python, report)


def score_fits(report: Report) -> Iterator[tuple[list[RealScore], list[Sightings]]]:
    """Clip by clip, the head fitted to each marked frame by itself; then the same on photographs,
    beside MediaPipe. Raises InvalidInput."""
    films = [Footage(footage_of(clip)) for clip in CLIPS]
    images = read_images()
    for clip, footage in zip(CLIPS, films, strict=True):
        labels = read_labels(clip)
        report(f"{clip}: fit, {len(labels.frame)} frames")
        yield [score_places(labels, FIRST_FIT, by_fit(labels, footage)), *_repeated(labels)], []
    yield score_photographs(images, face_mesh_python(report), report), []


def score_clip(
    labels: Labels, performance: Performance, python: Path | None, report: Report
) -> tuple[list[RealScore], list[Sightings]]:
    """Every method on one clip. python: of scripts/face_mesh_env, where it is available."""
    runs = still_runs(labels.clip, performance)
    every = with_frames(labels, runs.ravel())
    places_by_method = {OURS: by_capture(every, performance)}
    places_by_method[REGRESSOR] = by_regressor(every, performance)
    all_sightings = []
    if python is not None:
        report(f"{labels.clip}: {FACE_MESH}")
        places_by_method[FACE_MESH] = by_face_mesh(every, python)
    if (networks := installed_networks()) is not None:
        smaller = by_networks(every, performance, networks_alone(), SHRUNK)
        places_by_method[NETWORKS] = smaller[SHRUNK.index(1)]
        places_by_method[JOINED] = by_networks(every, performance, networks)[0]
        all_sightings = [
            sightings(every, performance, runs, places, times)
            for places, times in zip(smaller, SHRUNK, strict=True)
        ]
    else:
        report("no networks on our own crops: run scripts/make_networks and build again")
    is_marked = np.isin(every.frame, labels.frame)
    scores = []
    for method, places in places_by_method.items():
        variances = _jitter(every, places, performance, runs)
        scores.append(score_places(labels, method, places[is_marked], variances))
    events = {one.kind: one.text() for one in score_events(labels.clip, performance)}
    events["saturation"] = f"{labels.clip}: saturation: {100 * saturation(performance):.1f} %"
    events["saturation"] += " of the active muscle-frames are over .98"
    scores[0] = replace(scores[0], events=events)
    return scores + _repeated(labels), all_sightings


def _repeated(labels: Labels) -> list[RealScore]:
    """The second marking's score, if there is one."""
    again = read_labels(labels.clip, second=True)
    return [] if again is None else [_marked_again(labels, again)]


def _jitter(
    every: Labels,
    places: NDArray[np.float64],
    performance: Performance,
    runs: NDArray[np.int64],
) -> NDArray[np.float64]:
    """POINTS x 2 variances of places (N x POINTS x 2) in the face's square, in squares of the
    interpupillary distance: the median of the runs in which the face keeps still."""
    crops = [each.face for each in crops_of(performance, every.frame)]
    still = in_crops(places, crops)[np.searchsorted(every.frame, runs)]
    sides = np.array([crop.side for crop in crops])
    return np.nanmedian(jitter(still), axis=0) * np.nanmedian(sides / every.ipd) ** 2


def _marked_again(labels: Labels, again: Labels) -> RealScore:
    """How far a second marking is from the first, where there are both."""
    both = np.isin(labels.frame, again.frame)
    first, second = labels.rows(both), again.rows(np.isin(again.frame, labels.frame))
    return score_again(first, second.places)


def clip_text(scores: list[RealScore]) -> str:
    """Three tables of one clip: errors, how much of them is this person's own bias, and jitter.

    Of photographs two more: face by face, and point by point.
    """
    errors = {score.method: _row(score, "median", "p90") for score in scores}
    for score in scores:
        errors[score.method] |= {"told": score.lips_told, "seen": score.seen}
    columns = _columns("median", "p90", "90 %") | {"told": ("told", ".2f"), "seen": ("seen", ".2f")}
    parts = {score.method: _row(score, "bias", "left") for score in scores}
    jitters = {one.method: _row(one, "jitter") for one in scores if one.method != AGAIN}
    features = {f"{feature} jitter": (feature, ".2f") for feature in FEATURES}
    clip = f"{scores[0].clip}, % of IPD"
    return "\n\n".join(
        (
            text_table(f"{clip}: medians", columns, errors, cell=CELL),
            text_table(
                f"{clip}: bias, what is left", _columns("bias", "left", "left"), parts, CELL
            ),
            text_table(f"{clip}: jitter where still", features, jitters, CELL),
            *scores[0].events.values(),
            *faces_texts(scores),
        )
    )


def _columns(first: str, second: str, head: str) -> dict[str, tuple[str, str]]:
    columns = {}
    for feature in FEATURES:
        columns[f"{feature} {first}"] = (feature, ".1f")
        columns[f"{feature} {second}"] = (head, ".1f")
    return columns


def _row(score: RealScore, *keys: str) -> dict[str, float]:
    return {
        f"{feature} {key}": figures.get(key, np.nan)
        for feature, figures in score.figures.items()
        for key in keys
    }


def as_json(scores: list[RealScore]) -> str:
    return json_text([vars(score) for score in scores])
