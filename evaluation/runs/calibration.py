# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate calibration`: what calibration to a person gains on frames that it did not use.

Each person is calibrated on the first part of a clip; the whole clip is captured with and without,
from the same fit, and scored on both parts. Truth is moved by muscles attached 3 mm elsewhere on
skin held twice as stiffly, under large rotations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from mimetic import InvalidInput
from mimetic.muscles.calibration import REGIONS, Calibration
from mimetic.performance.document import Performance
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture
from mimetic.solve.calibrate import CalibrationResult, NothingSeen
from mimetic.solve.calibration_run import calibrate

from evaluation.runs import deviation, expressions
from evaluation.runs.deviation import Explained
from evaluation.runs.expressions import seen_at_start
from evaluation.runs.methods import of_performance
from evaluation.runs.rendered import Clip

TRUE_STIFFNESS = 2.0
FIRST_SHARE = 0.6  # of a clip without named expressions
PARTS = ("calibrated on", "other frames")
WITHOUT, WITH, TRUE = "not calibrated", "calibrated", "true stiffness"
COLUMNS = {
    "image": ("R2 image", ".3f"),
    "image_median": ("moving px", ".2f"),
    "space": ("R2 in space", ".3f"),
    "space_median": ("moving mm", ".2f"),
    "activations": ("act. RMSE", ".4f"),
}
FOUND = {name: (name, ".2f") for name in REGIONS} | {
    "mean": ("mean", ".2f"),
    "gain": ("evidence", "+.1f"),
}


@dataclass(frozen=True)
class Scored:
    """Muscles alone in one part of a clip, ready to be pooled; activations: squared errors."""

    image: Explained
    space: Explained
    activations: np.ndarray


@dataclass(frozen=True)
class Person:
    """One clip: the factors, and scores by calibration used and part of the clip."""

    name: str
    found: dict[str, float]
    scored: dict[tuple[str, str], Scored]


def score_calibration(
    which: str, people: int | None, report: Callable[[str], None]
) -> list[Person]:
    """Every person of a set who is moved by muscles."""
    people_scores = []
    for clip in expressions.clips_of(which, people, report):
        truth = Truth.load(clip.truth)
        if truth.muscles is not None:
            report(f"{clip.name}: calibrating")
            people_scores.append(score_person(clip, truth))
    if not people_scores:
        raise InvalidInput(f"--set {which}: nobody of it is moved by muscles; take more people")
    return people_scores


def score_person(clip: Clip, truth: Truth) -> Person:
    fit = clip_capture.find_face(clip.footage)
    split = num_first(truth)
    try:
        calibrated_fit, result = calibrate(clip.footage, (1, split), fit)
        figures = figures_of(result)
    except NothingSeen:
        calibrated_fit, figures = fit, {}
    calibrations = {
        WITHOUT: Calibration(),
        WITH: calibrated_fit.calibration,
        TRUE: Calibration(dict.fromkeys(REGIONS, TRUE_STIFFNESS)),
    }
    scores_by_case = {}
    for name, calibration in calibrations.items():
        performance = clip_capture.capture(clip.footage, fit=replace(fit, calibration=calibration))
        for part, score in zip(PARTS, score_parts(truth, performance, split), strict=True):
            scores_by_case[name, part] = score
    return Person(clip.name, figures, scores_by_case)


def num_first(truth: Truth) -> int:
    """Frames to calibrate on: all before the last expression."""
    if truth.expression_frames is None:
        return round(FIRST_SHARE * len(truth.frame))
    return int(np.searchsorted(truth.frame, truth.expression_frames[-1][0]))


def score_parts(truth: Truth, performance: Performance, split: int) -> tuple[Scored, Scored]:
    """Of muscles alone, up to and from frame `split` (an index)."""
    truth = seen_at_start(truth)
    motion = of_performance(performance.without_detail(), truth.tracks[0])
    image, space = deviation.in_image(truth, motion), deviation.in_space(truth, motion)
    order = [truth.muscles.index(name) for name in performance.muscles]
    error = (performance.activations - truth.activations[:, order]) ** 2
    parts = slice(0, split), slice(split, len(truth.frame))
    return tuple(
        Scored(Explained.of(image, rows), Explained.of(space, rows), error[rows]) for rows in parts
    )


def figures_of(result: CalibrationResult) -> dict[str, float]:
    """Factors by region, their geometric mean, and what evidence gained."""
    factors = {name: result.calibration.stiffness.get(name, 1.0) for name in REGIONS}
    mean = math.exp(np.mean(np.log(list(factors.values()))))
    return factors | {"mean": mean, "gain": result.gain}


def pooled(people: list[Person]) -> dict[str, dict[str, float]]:
    """Figures by part and by what was known, over all people."""
    rows = {}
    for part in PARTS:
        for case in (WITHOUT, WITH, TRUE):
            own = [person.scored[case, part] for person in people]
            image = Explained.all_of(one.image for one in own)
            space = Explained.all_of(one.space for one in own)
            error = np.concatenate([one.activations.ravel() for one in own])
            rows[f"{part}: {case}"] = {
                "image": image.r2,
                "image_median": image.median,
                "space": space.r2,
                "space_median": space.median,
                "activations": float(np.sqrt(error.mean())),
            }
    return rows


def as_text(people: list[Person]) -> str:
    factors = {person.name: person.found for person in people}
    tables = [text_table(f"attachment found (truth: {TRUE_STIFFNESS:g})", FOUND, factors)]
    tables += [text_table(person.name, COLUMNS, pooled([person])) for person in people]
    if len(people) > 1:
        tables.append(text_table(f"all {len(people)}", COLUMNS, pooled(people)))
    return "\n\n".join(tables)


def as_json(all_people: list[Person]) -> str:
    people = {
        person.name: {"found": person.found, "scores": pooled([person])} for person in all_people
    }
    return json_text({"people": people, "all": pooled(all_people)})
