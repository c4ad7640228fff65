# SPDX-License-Identifier: GPL-3.0-or-later
"""What builds up over a thousand frames, at the times at which the face is at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic.performance.document import Performance
from mimetic.score import scores
from mimetic.score.truth import Truth
from numpy.typing import NDArray

AT_REST = 0.01  # no control of the truth is above


@dataclass(frozen=True)
class Drift:
    """Per 1000 frames, and what is left of activations at rest."""

    activation: float  # largest of any muscle's slope
    degrees: float  # slope of the head's orientation error
    left_over: float  # root mean square of all activations at rest


def drift_of(truth: Truth, performance: Performance) -> Drift:
    common = np.intersect1d(truth.frame, performance.frame)
    true_rows = np.searchsorted(truth.frame, common)
    rows = np.searchsorted(performance.frame, common)
    controls = [v for v in (truth.unit_values, truth.activations) if v is not None]
    rest = np.concatenate(controls, axis=1)[true_rows].max(1) < AT_REST
    activations = performance.activations[rows][rest]
    error = scores.head_errors(truth.head_pose[true_rows], performance.head_pose[rows])[rest]
    return Drift(
        float(np.abs(_slopes(common[rest], activations)).max()),
        float(np.linalg.norm(_slopes(common[rest], error))),
        float(np.sqrt((activations**2).mean())),
    )


def _slopes(frame: NDArray, values: NDArray) -> NDArray[np.float64]:
    return 1000 * np.polyfit(frame, values, 1)[0]
