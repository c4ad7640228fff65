# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores one performance against one truth file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.performance.document import OPTIONAL, REQUIRED, Performance
from mimetic.score import scores
from mimetic.score import truth as truth_file
from mimetic.score.groups import UNIT_ARTICULATORS, group_curves
from mimetic.score.peers import dis_tracks
from mimetic.score.prediction import follow
from mimetic.score.truth import Truth

LEAST_FRAMES = 3
PERFORMANCE_KEYS = REQUIRED | OPTIONAL
Document = TypeVar("Document", Truth, Performance)


@dataclass
class Score:
    """All figures of one clip; nan where the truth does not determine them."""

    name: str
    num_frames: int
    on_face: float  # share of the points that the performance's surface covers in the first frame
    image: dict[str, dict[str, float]]  # who -> figure -> value; `mimetic` first, then peers
    surface: dict[str, float]
    head: dict[str, float]
    overall: dict[str, float] = field(default_factory=dict)
    controls: dict[str, dict[str, float]] = field(default_factory=dict)
    groups: dict[str, dict[str, float]] = field(default_factory=dict)
    largest_activation: float = float("nan")


def score(
    truth: Truth,
    performance: Performance,
    name: str = "",
    images: Iterable[NDArray[np.uint8]] | None = None,
) -> Score:
    """Every figure that the truth allows; peers that need the footage if its images are given.

    images: RGB uint8 of the frames that both files share, in order.
    """
    truth, performance = _shared_frames(truth, performance)
    at_start = truth.visible[0]
    if not at_start.any():
        raise InvalidInput("no point of the truth is visible in the first frame of both files")
    tracks, points = truth.tracks[:, at_start], truth.points[:, at_start]
    is_visible = truth.visible[:, at_start]
    rigid = scores.project(points[:1], truth.head_pose, truth.intrinsics)
    prediction = follow(performance, tracks[0])
    stiff = follow(_stiffened(performance), tracks[0])
    image = {"mimetic": scores.image_motion(tracks, rigid, is_visible, prediction.tracks)}
    if performance.detail_modes is not None:
        plain = follow(performance.without_detail(), tracks[0])
        image["its muscles alone"] = scores.image_motion(tracks, rigid, is_visible, plain.tracks)
    image |= {
        "its head motion alone": scores.image_motion(tracks, rigid, is_visible, stiff.tracks),
    }
    if images is not None:
        for peer, peer_tracks in dis_tracks(images, tracks[0]).items():
            image[f"DIS flow, {peer}"] = scores.image_motion(tracks, rigid, is_visible, peer_tracks)
    on_face = prediction.on_face
    result = Score(
        name=name,
        num_frames=len(truth.frame),
        on_face=float(on_face.mean()),
        image=image,
        surface=scores.surface_motion(
            points[:, on_face], is_visible[:, on_face], prediction.points[:, on_face]
        ),
        head=scores.head_motion(truth.head_pose, performance.head_pose),
        largest_activation=float(performance.activations.max()),
    )
    _score_controls(result, truth, performance)
    return result


def _stiffened(performance: Performance) -> Performance:
    """The same head motion with a face that does not move."""
    return replace(
        performance.without_detail(),
        activations=np.zeros_like(performance.activations),
        articulator_values=np.zeros_like(performance.articulator_values),
    )


def _shared_frames(truth: Truth, performance: Performance) -> tuple[Truth, Performance]:
    """Both cut to the frames that both have."""
    if tuple(truth.image_size) != tuple(performance.image_size):
        raise InvalidInput(
            f"the truth is of {truth.image_size.tolist()} pixels, the performance of "
            f"{performance.image_size.tolist()}: they are not of the same footage"
        )
    common = np.intersect1d(truth.frame, performance.frame)
    if len(common) < LEAST_FRAMES:
        raise InvalidInput(
            f"truth and performance share {len(common)} frames; at least {LEAST_FRAMES} are needed"
        )
    return _cut(truth, common), _cut(performance, common)


def _cut(document: Document, frames: NDArray[np.int64]) -> Document:
    """A copy with these frames alone."""
    keys = truth_file.KEYS if isinstance(document, Truth) else PERFORMANCE_KEYS
    rows = np.searchsorted(document.frame, frames)
    rows_of: dict[str, Any] = {
        key: np.asarray(getattr(document, key))[rows]
        for key, (_, shape) in keys.items()
        if shape[0] == "N" and getattr(document, key) is not None
    }
    return replace(document, **rows_of)


def _score_controls(result: Score, truth: Truth, performance: Performance) -> None:
    if truth.muscles is not None and truth.activations is not None:
        names = [name for name in truth.muscles if name in performance.muscles]
        ours = [performance.muscles.index(name) for name in names]
        theirs = [truth.muscles.index(name) for name in names]
        true, estimates = truth.activations[:, theirs], performance.activations[:, ours]
        std = performance.activations_std[:, ours]
        result.overall = scores.activations(true, estimates, std)
        for m, name in enumerate(names):
            if true[:, m].max() > scores.ACTIVE:
                result.controls[name] = _curve(true[:, m], estimates[:, m])
    if truth.units is not None and truth.unit_values is not None:
        for unit, articulators in UNIT_ARTICULATORS.items():
            if unit in truth.units:
                true = truth.unit_values[:, truth.units.index(unit)]
                _score_articulators(result, performance, unit, true, articulators)
    for name, true in zip(
        truth.articulators or [], _columns(truth.articulator_values), strict=True
    ):
        _score_articulators(result, performance, name, true, (name,))
    for name, (true, estimates) in group_curves(truth, performance).items():
        result.groups[name] = _curve(true, estimates)


def _score_articulators(
    result: Score, performance: Performance, label: str, true: NDArray, names: tuple[str, ...]
) -> None:
    indices = [performance.articulators.index(n) for n in names if n in performance.articulators]
    if indices and np.abs(true).max() > scores.ACTIVE:
        result.controls[label] = _curve(true, performance.articulator_values[:, indices].sum(1))


def _columns(values: NDArray | None) -> NDArray:
    return np.zeros((0, 0)) if values is None else values.T


def _curve(true: NDArray, estimates: NDArray) -> dict[str, float]:
    return {
        "correlation": scores.correlation(true, estimates),
        "rmse": float(np.sqrt(((estimates - true) ** 2).mean())),
        "true_peak": float(true.max()),
        "peak": float(estimates.max()),
        "lag_frames": scores.lag_frames(true, estimates),
    }


def shared_images(footage: Path, truth: Truth, performance: Performance) -> Iterator:
    """Images (H,W,3) of the frames that both have."""
    frames = set(truth.frame.tolist()) & set(performance.frame.tolist())
    for frame, image in Footage(footage):
        if frame in frames:
            yield image
