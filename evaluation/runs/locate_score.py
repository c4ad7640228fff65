# SPDX-License-Identifier: GPL-3.0-or-later
"""How often a finder finds, how often it errs, and how far its parts are off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evaluation.runs.finders import Found, Run
from evaluation.runs.stills import PARTS, Stills

# A face counts as found when its worse eye is within this part of the interpupillary distance
# [Jesorsky et al. 2001].
EYE_TOLERANCE = 0.25
FALSE_PER_IMAGE = 0.1  # where the rate to quote is read
TURNED = 15.0  # degrees of yaw from which a face counts as turned


@dataclass(frozen=True)
class LocateScore:
    """One finder on one set of images; errors in % of the interpupillary distance."""

    faces: int
    images: int
    false_per_image: NDArray[np.float64]  # rises; one entry a distinct score
    found_rate: NDArray[np.float64]  # at the same thresholds
    threshold: NDArray[np.float64]
    figures: dict[str, float]


def score_run(run: Run, stills: Stills) -> LocateScore:
    """Detection rate against false alarms, errors of the parts, time."""
    best = np.full(len(stills.images), -np.inf)
    errors = np.full((len(stills.images), len(PARTS)), np.nan)
    false = []
    for i, answers in enumerate(run.found):
        hit = _hit(answers, stills, i)
        false += [f.score for f in answers if f is not hit]
        if hit is not None:
            best[i] = hit.score
            off = np.linalg.norm(hit.places - stills.places[i], axis=1)
            errors[i] = 100 * off / stills.ipd[i]
    hits = best[stills.has_face]
    threshold = np.unique(np.concatenate([hits[np.isfinite(hits)], false]))[::-1]
    false_per_image = (np.array(false)[None] >= threshold[:, None]).sum(1) / len(stills.images)
    found_rate = (hits[None] >= threshold[:, None]).mean(1)
    yaw = np.abs(stills.yaw[stills.has_face])  # nan where it is not known
    is_frontal, is_turned = yaw < TURNED, yaw >= TURNED
    thresholds = threshold[false_per_image <= FALSE_PER_IMAGE]
    found_there = hits >= (thresholds.min() if len(thresholds) else np.inf)
    figures = {
        "found": _mean(found_there),
        "found_frontal": _mean(found_there[is_frontal]),
        "found_turned": _mean(found_there[is_turned]),
        "found_at_all": _mean(np.isfinite(hits)),
        "false_at_all": len(false) / len(stills.images),
        "ms": 1000 * float(np.median(run.seconds)),
    }
    for name, columns in (("eye", [0, 1]), ("nose", [2]), ("mouth", [3])):
        off = errors[np.isfinite(best)][:, columns].ravel()
        for suffix, share in (("median", 50), ("p90", 90)):
            value = float(np.percentile(off, share)) if len(off) else float("nan")
            figures[f"{name}_{suffix}"] = value
    return LocateScore(
        faces=int(stills.has_face.sum()),
        images=len(stills.images),
        false_per_image=false_per_image,
        found_rate=found_rate,
        threshold=threshold,
        figures=figures,
    )


def _hit(answer: list[Found], stills: Stills, i: int) -> Found | None:
    """The surest of an image's answers that is on its face; any other is a false alarm."""
    if not stills.has_face[i]:
        return None
    reach = EYE_TOLERANCE * stills.ipd[i]
    on_face = [
        f
        for f in answer
        if np.linalg.norm(f.places[:2] - stills.places[i, :2], axis=1).max() <= reach
    ]
    return max(on_face, key=lambda f: f.score, default=None)


def _mean(values: NDArray) -> float:
    return float(values.mean()) if len(values) else float("nan")
