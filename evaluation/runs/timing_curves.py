# SPDX-License-Identifier: GPL-3.0-or-later
"""Phases of made-up curves: what the fit alone recovers, without any capture."""

from __future__ import annotations

import numpy as np
from mimetic import _core

NOISES = (0.01, 0.02, 0.05)
NUM_EVENTS, NUM_FRAMES = 60, 100
COLUMNS = ("onset", "rise", "release", "amplitude", "exponent")


def curve_rows() -> list[tuple[str, str]]:
    """Median errors of each column at each noise, as lines of a table."""
    rows = []
    for noise in NOISES:
        errors = _errors(noise, np.random.default_rng(round(1000 * noise)))
        medians = np.median(np.abs(errors), axis=0)
        text = ", ".join(f"{n} {m:.3f}" for n, m in zip(COLUMNS, medians, strict=True))
        rows.append((f"noise {noise:g}: {len(errors)} of {NUM_EVENTS} found", text))
    return rows


def _errors(noise: float, rng: np.random.Generator) -> np.ndarray:
    frames = np.arange(1.0, NUM_FRAMES + 1)
    errors = []
    for _ in range(NUM_EVENTS):
        truth = _random_shape(rng)
        values = np.clip(truth.values(frames) + rng.normal(0, noise, NUM_FRAMES), 0, 1)
        options = _core.PhaseOptions()
        options.num_draws, options.measured_std = 0, 1e-9
        usable = [True] * NUM_FRAMES
        stds = np.full(NUM_FRAMES, noise)
        fits = _core.fit_phases(frames, values, stds, usable, options)
        fit = max(fits, key=lambda fit: fit.shape.amplitude, default=None)
        if fit is not None:
            pairs = zip(_columns(fit.shape), _columns(truth), strict=True)
            errors.append([one - other for one, other in pairs])
    return np.array(errors)


def _columns(shape: _core.PhaseShape) -> tuple[float, ...]:
    return (shape.onset, shape.rise, shape.release, shape.amplitude, shape.exponent)


def _random_shape(rng: np.random.Generator) -> _core.PhaseShape:
    shape = _core.PhaseShape()
    shape.amplitude, shape.onset = rng.uniform(0.5, 0.9), rng.uniform(14, 20)
    shape.rise, shape.hold = rng.uniform(8, 16), rng.uniform(6, 14)
    shape.exponent, shape.release_time = rng.uniform(-3, 3), rng.uniform(3, 5)
    if rng.random() < 0.5:
        shape.model = _core.PhaseModel.two_exponentials
        shape.relaxation_time, shape.relaxed_share = rng.uniform(12, 18), 0.3
    return shape
