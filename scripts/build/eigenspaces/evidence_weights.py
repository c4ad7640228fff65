# SPDX-License-Identifier: GPL-3.0-or-later
"""Weights of the evidence: logistic regression over what the search finds in scenes."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mimetic import _core
from mimetic.shared.installed_data import data_folder
from PIL import Image

from .pictures import Pictures
from .scenes import Scene, empty, jumbled, mirrored, photographed, portrait, spectacled
from .windows import middle_of

LARGEST_YAW = 33.0  # degrees
PORTRAITS, EMPTIES = 200, 50  # scenes; the latter of each of three kinds
SMALLEST = 40.0  # pixels, of the face's window
LARGEST_ERROR = 0.25  # of the worse eye, interpupillary distances
CASCADE = "haarcascade_frontalface_alt2.xml"
BOX_MIDDLE, WINDOW_PER_BOX = np.array([0.5, 0.61]), 0.85  # as native/src/locate/locate.cpp has them
RIDGE = 0.3
RATIO, FIRST_WEIGHT = 1, 0.02  # which evidence is the log likelihood ratio; log odds a unit
ROUNDS = 2


def with_weights(
    spaces: _core.FaceSpaces,
    pictures: Pictures,
    natural: list[np.ndarray],
    report: Callable[[str], None],
) -> _core.FaceSpaces:
    """The spaces with weights by which the log odds of a face are right.

    The search keeps the most probable of places that overlap, so that what is there to weigh
    depends on weights: first those of the likelihood ratio alone, then what they lead to.
    """
    scenes = list(_scenes(pictures, natural))
    weights = np.zeros(len(spaces.weights))
    weights[RATIO] = FIRST_WEIGHT
    for number in range(ROUNDS):
        spaces = _core.FaceSpaces(spaces.views, spaces.other, spaces.modules, weights)
        evidence, is_face = _evidence(spaces, scenes)
        message = f"{len(evidence)} places in scenes, {int(is_face.sum())} of them faces"
        report(f"weights, round {number + 1}: {message}")
        weights = logistic(evidence, is_face)
    return _core.FaceSpaces(spaces.views, spaces.other, spaces.modules, weights)


def logistic(evidence: np.ndarray, is_face: np.ndarray) -> np.ndarray:
    """Weights (E) and a constant of the log odds, by Newton's method with a ridge."""
    mean, deviation = evidence.mean(0), evidence.std(0) + 1e-9
    rows = np.column_stack([(evidence - mean) / deviation, np.ones(len(evidence))])
    ridge = RIDGE * np.diag([1.0] * evidence.shape[1] + [0.0])
    weights = np.zeros(rows.shape[1])
    for _ in range(30):
        odds = 1 / (1 + np.exp(-np.clip(rows @ weights, -60, 60)))
        curvature = (rows * (odds * (1 - odds) + 1e-9)[:, None]).T @ rows + ridge
        weights += np.linalg.solve(curvature, rows.T @ (is_face - odds) - ridge @ weights)
    slopes = weights[:-1] / deviation
    return np.append(slopes, weights[-1] - slopes @ mean)


def _scenes(pictures: Pictures, natural: list[np.ndarray]):
    rng = np.random.default_rng(77)
    fronts = rng.permutation(pictures.fronts[np.abs(pictures.yaw[pictures.fronts]) < LARGEST_YAW])
    backs = rng.permutation(pictures.backs)
    for i, row in enumerate(fronts[:PORTRAITS]):
        grey, places = pictures.grey[row], pictures.places[row]
        if i % 8 == 0:
            grey = spectacled(grey, places, rng)
        if i % 2:
            grey, places = mirrored(grey, places)
        yield portrait(grey, 400_000 + i, rng, places)
    for i in range(EMPTIES):
        yield Scene(photographed(empty(500_000 + i), rng))
        yield portrait(pictures.grey[backs[i % len(backs)]], 510_000 + i, rng)
        whole = portrait(pictures.grey[fronts[i % len(fronts)]], 520_000 + i, rng)
        yield Scene(jumbled(whole.grey, rng))
    for image in natural:
        for i, size in enumerate((1.0, 0.7, 0.85)):
            sides = [int(size * side) for side in image.shape[::-1]]
            small = np.asarray(Image.fromarray(image).resize(sides))
            if min(sides) >= 120:
                yield Scene(photographed(small[:, ::-1] if i == 1 else small, rng))


def _evidence(spaces: _core.FaceSpaces, scenes: list[Scene]) -> tuple[np.ndarray, np.ndarray]:
    """What is found in scenes, and which of it is a face. Places near a face are left out."""
    finder = _core.FaceFinder(spaces)
    cascade = _core.CascadeDetector(str(data_folder() / CASCADE))
    options = _core.FaceSearch(smallest=SMALLEST, least_probability=0.0)
    evidence, is_face = [], []
    for scene in scenes:
        grey = np.ascontiguousarray(scene.grey)
        hints = [
            _core.FaceHint(
                hit.box[:2] + hit.box[2] * BOX_MIDDLE, WINDOW_PER_BOX * hit.box[2], hit.votes
            )
            for hit in cascade.detect(np.repeat(grey[..., None], 3, axis=2))
        ]
        for face in finder.find(grey, options, hints):
            kind = _kind(face, scene)
            if kind is not None:
                evidence.append(face.evidence)
                is_face.append(kind)
    return np.array(evidence), np.array(is_face, float)


def _kind(face: _core.FoundFace, scene: Scene) -> bool | None:
    """Whether it is the scene's face; None for what is neither quite a face nor none."""
    if scene.places is None:
        return False
    off = np.linalg.norm(face.places[:2] - scene.places[:2], axis=1).max()
    if off < LARGEST_ERROR * scene.ipd:
        return True
    near = np.linalg.norm(face.center - middle_of(scene.places)) < 0.35 * face.width
    alike = abs(np.log(face.width / (2 * scene.ipd))) < 0.5
    return None if near and alike else False
