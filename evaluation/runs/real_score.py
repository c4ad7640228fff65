# SPDX-License-Identifier: GPL-3.0-or-later
"""How far points are from those marked by hand, in % of the interpupillary distance."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from evaluation.runs.real_labels import POINTS, Labels

# Points along a margin all look alike: only the error across it is counted
ACROSS_EYE = ("lids",)
ACROSS_MOUTH = ("outer lips", "inner lips")
FEATURES = {
    "lids": tuple(f"lid_{part}.{side}" for side in "RL" for part in ("upper", "lower")),
    "eye corners": tuple(f"eye_{part}.{side}" for side in "RL" for part in ("outer", "inner")),
    "iris": ("iris.R", "iris.L"),
    "mouth corners": ("mouth_corner.R", "mouth_corner.L"),
    "outer lips": ("lip_outer_upper", "lip_outer_lower"),
    "inner lips": ("lip_inner_upper", "lip_inner_lower"),
}
# Methods, as the tables call them
FACE_MESH, FIRST_FIT, AGAIN = "MediaPipe, refined", "first fit", "marked again"
APART = 2.0  # % of the interpupillary distance between inner lips from which they count as parted


@dataclass(frozen=True)
class RealScore:
    """Of one method on one clip: by feature median, p90, bias and what a known bias leaves."""

    clip: str
    method: str
    figures: dict[str, dict[str, float]] = field(default_factory=dict)
    lips_told: float = math.nan  # share of the frames in which lips are rightly apart or touching
    seen: float = math.nan  # share of the marked points that the method has a place for
    events: dict[str, str] = field(default_factory=dict)  # of a capture: by kind, how many it finds
    # Of photographs, each of another person: mean error by face and feature, and by point how far
    # it lies off on the mean: toward the subject's left, and down
    faces: dict[str, dict[str, float]] = field(default_factory=dict)
    points: dict[str, tuple[float, float]] = field(default_factory=dict)


def score_places(
    labels: Labels,
    method: str,
    places: NDArray[np.float64],
    jitter: NDArray[np.float64] | None = None,
) -> RealScore:
    """places: N x POINTS x 2, pixels, nan where the method has none. jitter: POINTS x 2 variances
    where the face keeps still, along and across, in squares of the interpupillary distance."""
    off = in_face_frame(labels, places - labels.places)
    figures = {}
    for feature, names in FEATURES.items():
        errors = _errors(off, feature)
        figures[feature] = _figures(errors)
        if jitter is not None:
            spread = jitter[[POINTS.index(name) for name in names], 2 - errors.shape[2] :]
            figures[feature]["jitter"] = 100 * math.sqrt(spread.sum(axis=1).mean())
    is_marked = np.isfinite(labels.places).all(axis=2)
    has = np.isfinite(places).all(axis=2)
    return RealScore(
        labels.clip,
        method,
        figures,
        _lips_told(labels, places),
        float(has[is_marked].mean()),
    )


def score_again(labels: Labels, second: NDArray[np.float64]) -> RealScore:
    """How far a second marking (N x POINTS x 2) is from the first, where there are both."""
    return score_places(labels, AGAIN, np.where(np.isfinite(labels.places), second, np.nan))


def with_faces(
    score: RealScore, names: list[str], labels: Labels, places: NDArray[np.float64]
) -> RealScore:
    """The score with what photographs (N names) tell beside it: face by face, point by point."""
    off = in_face_frame(labels, places - labels.places)
    faces: dict[str, dict[str, float]] = {name: {} for name in names}
    for feature in FEATURES:
        sizes = np.linalg.norm(_errors(off, feature), axis=2)
        for name, of_face in zip(names, sizes, strict=True):
            known = of_face[np.isfinite(of_face)]
            faces[name][feature] = float(known.mean()) if len(known) else math.nan
    known = np.isfinite(off)
    means = np.where(known, off, 0).sum(axis=0) / np.maximum(1, known.sum(axis=0))
    points = {name: (float(x), float(y)) for name, (x, y) in zip(POINTS, means, strict=True)}
    return replace(score, faces=faces, points=points)


def _errors(off: NDArray[np.float64], feature: str) -> NDArray[np.float64]:
    """N x a feature's points x what is counted of them."""
    errors = off[:, [POINTS.index(name) for name in FEATURES[feature]]]
    return errors[..., 1:] if feature in ACROSS_EYE + ACROSS_MOUTH else errors


def in_face_frame(labels: Labels, off: NDArray[np.float64]) -> NDArray[np.float64]:
    """Differences (N x POINTS x 2, pixels) along and across the marked line of each point's eye,
    of the lips' the mouth's, in % of the interpupillary distance."""
    components = np.empty_like(off)
    for i, name in enumerate(POINTS):
        if name.startswith(("eye", "lid", "iris")):
            side = name[-1]
            ends = labels.of(*(f"eye_{part}.{side}" for part in ("outer", "inner")))
            ends = ends if side == "R" else ends[:, ::-1]
        else:
            ends = labels.of("mouth_corner.R", "mouth_corner.L")
        along = ends[:, 1] - ends[:, 0]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)  # downwards in an upright face
        components[:, i, 0] = (off[:, i] * along).sum(axis=1)
        components[:, i, 1] = (off[:, i] * across).sum(axis=1)
    return 100 * components / labels.ipd[:, None, None]


def _figures(off: NDArray[np.float64]) -> dict[str, float]:
    """off: N x points x 1 or 2, %."""
    sizes = np.linalg.norm(off, axis=2)
    sizes = sizes[np.isfinite(sizes)]
    if not len(sizes):
        return {}
    bias = np.nanmean(off, axis=0) if len(off) else np.nan
    return {
        "median": float(np.median(sizes)),
        "p90": float(np.quantile(sizes, 0.9)),
        "bias": float(np.sqrt((bias**2).sum(axis=-1).mean())),
        "left": _left(off),
    }


def _left(off: NDArray[np.float64]) -> float:
    """The median error once each point's mean error in the clip's other frames is taken away."""
    remainders = np.linalg.norm(without_bias(off), axis=2)
    remainders = remainders[np.isfinite(remainders)]
    return float(np.median(remainders)) if len(remainders) else math.nan


def without_bias(off: NDArray[np.float64]) -> NDArray[np.float64]:
    """Errors (N x K x D) less each point's mean error in the other frames."""
    is_known = np.isfinite(off)
    total, number = np.where(is_known, off, 0).sum(axis=0), is_known.sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return off - (total - np.where(is_known, off, 0)) / (number - is_known)


def _lips_told(labels: Labels, places: NDArray[np.float64]) -> float:
    gap = lips_gap(labels, places)
    is_known = np.isfinite(labels.touch) & np.isfinite(gap)
    if not is_known.any():
        return math.nan
    return float(((gap[is_known] < APART) == (labels.touch[is_known] > 0.5)).mean())


def lips_gap(labels: Labels, places: NDArray[np.float64]) -> NDArray[np.float64]:
    """N: how far the inner lips (of places, N x POINTS x 2) are apart on the midline, in % of the
    interpupillary distance; below 0 where one covers the other.

    Lips that touch and are shifted along each other are not parted: only what lies across the
    marked line of the mouth's corners.
    """
    upper, lower = (POINTS.index(f"lip_inner_{part}") for part in ("upper", "lower"))
    right, left = labels.of("mouth_corner.R", "mouth_corner.L").transpose(1, 0, 2)
    downwards = np.stack([right[:, 1] - left[:, 1], left[:, 0] - right[:, 0]], axis=1)
    downwards /= np.linalg.norm(downwards, axis=1, keepdims=True)
    return 100 * ((places[:, lower] - places[:, upper]) * downwards).sum(axis=1) / labels.ipd
