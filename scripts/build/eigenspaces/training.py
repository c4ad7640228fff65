# SPDX-License-Identifier: GPL-3.0-or-later
"""Filters and spaces of faces, against hard negatives that the filters themselves find."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic import _core
from mimetic.locate.eigenspaces import train
from numpy.lib.stride_tricks import sliding_window_view

from .evidence_weights import with_weights
from .natural import natural_images
from .pictures import Pictures, drawn_pictures
from .scenes import empty, jumbled, photographed, portrait
from .windows import FACE_IPDS, FACE_SIDE, MODULES, Windows, windows_of

VIEW_YAWS = (-24.0, 0.0, 24.0)
VIEW_REACH = 15.0  # degrees: neighbours overlap
FACE_MODES, OTHER_MODES = 20, 40
MODULE_MODES, BESIDE_MODES = 16, 24
SHRINKAGE = 0.02
FILTER_SHRINKAGE = 0.05
MISSED = 0.005  # part of the faces of a view that its filter may drop
EMPTIES, BACKS, JUMBLES = 26, 18, 14  # negative images beside the photographs
RANDOM_AN_IMAGE = 160  # windows
HARD_A_LEVEL = 30
ROUNDS = 3
SMALLEST = 44.0  # pixels, of the windows in negative images


def face_spaces(
    people: int, jobs: int, cache: Path, report: Callable[[str], None]
) -> _core.FaceSpaces:
    """The model of this many people; the same for the same sources."""
    pictures = drawn_pictures(people, jobs, cache, report)
    report(f"{len(pictures.grey)} pictures of {people} people")
    rng = np.random.default_rng(5)
    windows = windows_of(pictures, rng)
    report(f"{len(windows.faces)} windows of faces")
    natural = natural_images(cache)
    levels = _levels([*_drawn_negatives(pictures, rng), *natural])
    spaces = _trained(windows, levels, rng, report)
    return with_weights(spaces, pictures, natural, report)


def _drawn_negatives(pictures: Pictures, rng: np.random.Generator) -> list[np.ndarray]:
    images = [photographed(empty(300_000 + i), rng) for i in range(EMPTIES)]
    for i, row in enumerate(rng.choice(pictures.backs, BACKS)):
        images.append(portrait(pictures.grey[row], 310_000 + i, rng).grey)
    for i, row in enumerate(rng.choice(pictures.fronts, JUMBLES)):
        images.append(jumbled(portrait(pictures.grey[row], 320_000 + i, rng).grey, rng))
    return images


def _levels(images: list[np.ndarray]) -> list[np.ndarray]:
    """Every level of every image as windows, rows x cols x side x side."""
    options = _core.FaceSearch(smallest=SMALLEST)
    levels = []
    for image in images:
        for level, _ in _core.flat_levels(np.ascontiguousarray(image), FACE_SIDE, options):
            levels.append(sliding_window_view(level.astype(np.float32), (FACE_SIDE, FACE_SIDE)))
    return levels


def _trained(
    windows: Windows,
    levels: list[np.ndarray],
    rng: np.random.Generator,
    report: Callable[[str], None],
) -> _core.FaceSpaces:
    faces, yaws = np.array(windows.faces), np.array(windows.yaws)
    by_view = [faces[np.abs(yaws - at) <= VIEW_REACH] for at in VIEW_YAWS]
    beside = np.array(windows.beside)
    filters, thresholds, hard = _filters(by_view, beside, levels, rng, report)
    false_alarms = beside[(beside @ filters.T - thresholds).max(1) > 0]
    sides = (FACE_SIDE, FACE_SIDE)
    others = np.concatenate([hard, false_alarms]).reshape(-1, *sides)
    places, place_yaws = np.array(windows.places), np.array(windows.place_yaws)
    views = []
    for i, at in enumerate(VIEW_YAWS):
        near = places[np.abs(place_yaws - at) <= VIEW_REACH].reshape(-1, 2 * len(MODULES))
        space = train(by_view[i].reshape(-1, *sides), FACE_MODES, SHRINKAGE)
        covariance = np.cov(near.T) + 2e-5 * np.eye(near.shape[1])
        views.append(
            _core.ViewSpace(at, filters[i], thresholds[i], space, near.mean(0), covariance)
        )
    modules = []
    for name, (ipds, (width, height)) in MODULES.items():
        both = [
            train(np.array(rows).reshape(-1, height, width), modes, SHRINKAGE)
            for rows, modes in (
                (windows.modules[name], MODULE_MODES),
                (windows.beside_modules[name], BESIDE_MODES),
            )
        ]
        modules.append(_core.ModuleSpace(name, *both, ipds / FACE_IPDS))
    evidence = 7 + len(modules)
    weights = np.zeros(evidence + 1)
    return _core.FaceSpaces(views, train(others, OTHER_MODES, SHRINKAGE), modules, weights)


def _filters(
    by_view: list[np.ndarray],
    beside: np.ndarray,
    levels: list[np.ndarray],
    rng: np.random.Generator,
    report: Callable[[str], None],
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Filters (V,N), thresholds (V) and the windows (K,N) that pass the last of them."""
    a_level = max(1, RANDOM_AN_IMAGE // 8)
    random = [
        level[rng.integers(0, level.shape[0], a_level), rng.integers(0, level.shape[1], a_level)]
        for level in levels
    ]
    negatives = np.concatenate([*(r.reshape(a_level, -1) for r in random), beside])
    hard = negatives[:0]
    for turn in range(ROUNDS):
        against = np.concatenate([negatives, hard, hard])
        filters = np.array([_fisher(faces, against) for faces in by_view])
        thresholds = np.array(
            [np.quantile(faces @ f, MISSED) for faces, f in zip(by_view, filters, strict=True)]
        )
        passing, total, windows = 0, 0, []
        for level in levels:
            rows = level.reshape(-1, FACE_SIDE**2)
            response = (rows @ filters.T - thresholds).max(1)
            best = np.argsort(-response)[:HARD_A_LEVEL]
            windows.append(rows[best[response[best] > 0]])
            passing, total = passing + (response > 0).sum(), total + len(rows)
        hard = np.concatenate(windows)
        report(f"filters, round {turn + 1}: {100 * passing / total:.1f} % of empty windows pass")
        if turn + 1 < ROUNDS:
            sample = hard[rng.permutation(len(hard))[:6000]]
            negatives = np.concatenate([negatives, sample])
    return filters.astype(float), thresholds, hard


def _fisher(faces: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Fisher's linear discriminant, of length 1."""
    within = (np.cov(faces.T) + np.cov(others.T)) / 2
    within += FILTER_SHRINKAGE * np.trace(within) / len(within) * np.eye(len(within))
    direction = np.linalg.solve(within, faces.mean(0) - others.mean(0))
    return (direction / np.linalg.norm(direction)).astype(np.float32)
