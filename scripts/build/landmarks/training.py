# SPDX-License-Identifier: GPL-3.0-or-later
"""The cascade: stage by stage, ridge regression from descriptors to how far landmarks are off."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from mimetic import _core
from mimetic.locate.landmarks import landmark_points, mirrored_order
from mimetic.template.face_template import FaceTemplate

from .samples import Sample, sample
from .shots import SHOTS, Shots

VIEW_YAWS = (-28.0, 0.0, 28.0)
VIEW_REACH = 16.0  # degrees
CELLS = (0.24, 0.17, 0.12, 0.09)  # IPD, one a stage
COMPONENTS = 36  # of a descriptor
RANK = 64  # of a regression
RIDGE = 0.05  # of the mean variance of the components
HELD_BACK = 10  # every so manieth person is not trained on: errors are measured there
REPEATS = 3  # samples a shot


def laid_on_pupils(places: np.ndarray, pupils: np.ndarray) -> np.ndarray:
    """Places (L,2) with the pupils (2,2; left first) at (0.5, 0) and (-0.5, 0)."""
    across, middle = pupils[0] - pupils[1], pupils.mean(0)
    turn = np.array([[across[0], across[1]], [-across[1], across[0]]]) / (across @ across)
    return (places - middle) @ turn.T


def similarity(source: np.ndarray, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Turn with size (2,2) and shift (2) that align places with others, least squares."""
    middle, aim = source.mean(0), target.mean(0)
    a, b = source - middle, target - aim
    c = (a * b).sum() / (a * a).sum()
    s = (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() / (a * a).sum()
    turn = np.array([[c, -s], [s, c]])
    return turn, aim - turn @ middle


def trained(
    shots: Shots, template: FaceTemplate, jobs: int, report: Callable[[str], None]
) -> dict[str, np.ndarray]:
    """The arrays of `mimetic.locate.landmarks.SHAPES`."""
    order = mirrored_order(template)
    with ThreadPoolExecutor(jobs) as pool:
        rows = [(i, seed) for i in range(len(shots.grey)) for seed in range(REPEATS)]
        samples = list(pool.map(lambda row: sample(shots, row[0], order, row[1]), rows))
        report(f"{len(samples)} samples")
        is_held_back = np.array([(i // SHOTS) % HELD_BACK == 0 for i, _ in rows])
        return _cascade(samples, is_held_back, landmark_points(template)[0], pool, report)


def _cascade(samples: list[Sample], is_held_back, names, pool, report) -> dict[str, np.ndarray]:
    reference, starts = _starts(samples)
    places = [_start(one, starts) for one in samples]
    cell_arrays: dict[str, list] = {n: [] for n in ("means", "bases", "outputs", "inputs")}
    _report_errors(report, "start", samples, places, reference, is_held_back)
    for cell in CELLS:
        descriptors = np.stack(
            list(
                pool.map(
                    lambda pair, cell=cell: _described(pair[0], pair[1], reference, cell),
                    zip(samples, places, strict=True),
                )
            )
        )
        mean, basis = _components(descriptors[~is_held_back])
        values = _evidence(descriptors, mean, basis)
        turns = [similarity(reference, p)[0] for p in places]
        off = np.stack(
            [
                ((one.places - p) @ np.linalg.inv(turn).T).ravel()
                for one, p, turn in zip(samples, places, turns, strict=True)
            ]
        )
        regression = _ridge(values[~is_held_back], off[~is_held_back])
        u, s, vt = np.linalg.svd(regression, full_matrices=False)
        outputs, inputs = (u[:, :RANK] * s[:RANK]), vt[:RANK]
        shifts = (values @ inputs.T @ outputs.T).reshape(len(samples), -1, 2)
        places = [p + d @ t.T for p, d, t in zip(places, shifts, turns, strict=True)]
        for name, array in zip(cell_arrays, (mean, basis, outputs, inputs), strict=True):
            cell_arrays[name].append(array)
        _report_errors(report, f"cell {cell}", samples, places, reference, is_held_back)
    arrays = {name: np.stack(rows).astype(np.float16) for name, rows in cell_arrays.items()}
    return arrays | {
        "names": np.array(names),
        "reference": reference,
        "yaws": np.array(VIEW_YAWS),
        "starts": np.stack(starts),
        "sigmas": _sigmas(samples, places, reference, is_held_back),
        "cells": np.array(CELLS),
    }


def _starts(samples: list[Sample]) -> tuple[np.ndarray, list[np.ndarray]]:
    """The reference (L,2) and the start of each view, pupils at (-0.5, 0) and (0.5, 0)."""
    yaws = np.array([one.yaw for one in samples])
    shapes = np.stack([laid_on_pupils(one.places, one.pupils) for one in samples])
    starts = [np.median(shapes[np.abs(yaws - at) < VIEW_REACH], axis=0) for at in VIEW_YAWS]
    return starts[len(starts) // 2], starts


def _start(one: Sample, starts: list[np.ndarray]) -> np.ndarray:
    view = starts[int(np.argmin(np.abs(np.array(VIEW_YAWS) - one.seen_yaw)))]
    across, middle = one.pupils[0] - one.pupils[1], one.pupils.mean(0)
    turn = np.array([[across[0], -across[1]], [across[1], across[0]]])
    return view @ turn.T + middle


def _described(one: Sample, places: np.ndarray, reference: np.ndarray, cell: float) -> np.ndarray:
    rows = _core.landmark_descriptors(one.image, np.ascontiguousarray(places), reference, cell)
    return rows.astype(np.float32)


def _components(descriptors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (D) and principal components (M,D) of descriptors, rounded as they are kept."""
    rng = np.random.default_rng(3)
    rows = descriptors.reshape(-1, descriptors.shape[-1])
    rows = rows[rng.choice(len(rows), min(len(rows), 40_000), replace=False)].astype(float)
    mean = rows.mean(0).astype(np.float16).astype(float)
    values, vectors = np.linalg.eigh(np.cov((rows - mean).T))
    basis = vectors[:, np.argsort(-values)[:COMPONENTS]].T
    return mean, basis.astype(np.float16).astype(float)


def _evidence(descriptors: np.ndarray, mean: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """N x (L M + 1), single precision."""
    values = (descriptors - mean.astype(np.float32)) @ basis.T.astype(np.float32)
    values = values.reshape(len(descriptors), -1)
    return np.column_stack([values, np.ones(len(values), np.float32)])


def _ridge(values: np.ndarray, targets: np.ndarray) -> np.ndarray:
    """Outputs x inputs; the constant, the last input, is not regularised."""
    gram = (values.T @ values).astype(float)
    size = np.trace(gram[:-1, :-1]) / (len(gram) - 1)
    gram[np.diag_indices(len(gram) - 1)] += RIDGE * size
    return np.linalg.solve(gram, values.T.astype(float) @ targets).T


def _off(samples, places, reference) -> np.ndarray:
    """How far landmarks are off (N,L,2), IPD of the reference."""
    rows = []
    for one, p in zip(samples, places, strict=True):
        turn, _ = similarity(reference, one.places)
        rows.append((p - one.places) @ np.linalg.inv(turn).T)
    return np.stack(rows)


def _report_errors(report, what, samples, places, reference, is_held_back) -> None:
    off = np.linalg.norm(_off(samples, places, reference), axis=2)
    texts = []
    yaws = np.abs([one.yaw for one in samples])
    for low, high in ((0, 12), (12, 28), (28, 90)):
        rows = is_held_back & (yaws >= low) & (yaws < high)
        texts.append(f"{100 * np.median(off[rows]):.1f}/{100 * np.percentile(off[rows], 90):.1f}")
    report(
        f"{what}: median/90 % of IPD, held back by yaw {', '.join(texts)}; "
        f"trained on {100 * np.median(off[~is_held_back]):.1f}"
    )


def _sigmas(samples, places, reference, is_held_back) -> np.ndarray:
    """V x L: rms errors of the people held back."""
    off, yaws = _off(samples, places, reference), np.array([one.yaw for one in samples])
    rows = []
    for at in VIEW_YAWS:
        errors = off[is_held_back & (np.abs(yaws - at) < VIEW_REACH)]
        rows.append(np.sqrt((errors**2).mean(axis=(0, 2))))
    return np.stack(rows)
