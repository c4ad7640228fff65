# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways to find faces and their parts in an image: ours, and OpenCV's cascades by themselves."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import _core
from mimetic.score.luminance import GREY
from mimetic.shared.installed_data import data_folder
from numpy.typing import NDArray

from evaluation.runs.stills import PARTS, Stills

DEBIANS = Path("/usr/share/opencv4")  # of the package opencv-data
CASCADES = {
    "Haar cascade": DEBIANS / "haarcascades" / "haarcascade_frontalface_alt2.xml",
    "LBP cascade": DEBIANS / "lbpcascades" / "lbpcascade_frontalface_improved.xml",
}
SMALLEST_FACE = 0.1  # of the shorter side: two interpupillary distances, as capture searches
LEAST_PROBABILITY = 0.001


@dataclass(frozen=True)
class Found:
    """What may be a face: the higher the score, the surer."""

    score: float
    places: NDArray[np.float64]  # parts x 2, pixels, in the order of stills.PARTS


@dataclass(frozen=True)
class Run:
    """One finder's answers to every image and the time it took for each."""

    found: list[list[Found]]
    seconds: NDArray[np.float64]


def run_locator(stills: Stills, spaces: _core.FaceSpaces | None) -> Run:
    """Mimetic's finder as capture uses it, or without spaces what it falls back on: cascades."""
    locator = _core.FaceLocator(str(data_folder()), spaces=spaces)
    answers, seconds = _timed(locator.locate, stills)
    return Run([[Found(f.likelihood, _parts_of(f)) for f in faces] for faces in answers], seconds)


def run_eigenspaces(spaces: _core.FaceSpaces, stills: Stills) -> Run:
    """Eigenspaces by themselves, without a cascade's hints, the parts where the modules are."""
    finder = _core.FaceFinder(spaces)
    rows = [spaces.module(name) for name in PARTS]
    smallest = SMALLEST_FACE * min(stills.images.shape[1:3])
    options = _core.FaceSearch(smallest=smallest, least_probability=LEAST_PROBABILITY)

    def find(image: NDArray[np.uint8]) -> list[_core.FoundFace]:
        return finder.find(np.round(image @ GREY).astype(np.uint8), options)

    answers, seconds = _timed(find, stills)
    return Run(
        [[Found(f.probability, f.places[rows]) for f in faces] for faces in answers], seconds
    )


def run_cascade(file: Path, stills: Stills) -> Run:
    """A cascade, its votes as scores.

    A cascade gives a box alone; the parts are taken at fixed shares of it, the medians over this
    very set: an upper limit for a box, known only in hindsight.
    """
    detector = _core.CascadeDetector(str(file))
    answers, seconds = _timed(detector.detect, stills)
    boxes = [[hit.box for hit in hits] for hits in answers]
    shares = part_shares(boxes, stills)
    candidates = [
        [Found(hit.votes, hit.box[:2] + hit.box[2] * shares) for hit in hits] for hits in answers
    ]
    return Run(candidates, seconds)


def part_shares(boxes: list[list[NDArray]], stills: Stills) -> NDArray[np.float64]:
    """Where the parts lie in boxes round faces (parts x 2), as shares of the box's width.

    Of a face's boxes, the one whose middle is nearest to the middle of the parts counts.
    """
    shares = []
    for around, places, has_face in zip(boxes, stills.places, stills.has_face, strict=True):
        if not has_face or not around:
            continue
        middle = places.mean(0)
        off = [np.linalg.norm(box[:2] + box[2:] / 2 - middle) / box[2] for box in around]
        box = around[int(np.argmin(off))]
        if min(off) < 0.5:
            shares.append((places - box[:2]) / box[2])
    if not shares:
        return np.full(stills.places.shape[1:], 0.5)
    return np.median(shares, axis=0)


def _timed(find: Callable, stills: Stills) -> tuple[list, NDArray[np.float64]]:
    find(stills.images[0])  # the first call warms up
    answers, seconds = [], []
    for image in stills.images:
        start = time.perf_counter()
        answers.append(find(image))
        seconds.append(time.perf_counter() - start)
    return answers, np.array(seconds)


def _parts_of(face: _core.FaceFeatures) -> NDArray[np.float64]:
    at = {feature.name: feature.position for feature in face.features}
    nose = (at["ala.L"] + at["ala.R"]) / 2
    mouth = (at["mouth_corner.L"] + at["mouth_corner.R"]) / 2
    return np.array([at["pupil.L"], at["pupil.R"], nose, mouth])
