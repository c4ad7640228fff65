# SPDX-License-Identifier: GPL-3.0-or-later
"""Patches of drawn people, and the eigenspaces of them."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mimetic import _core
from mimetic.eigenspaces import Eigenspaces, train
from mimetic.face_template import load_template
from PIL import Image

from .people import PX_PER_IPD, Person, Picture

FIRST_SEED = 1000  # people of evaluation/stills have seeds below
PICTURES_A_PERSON = 8
FACE_IPDS = 2.0  # width of the face's patch: temple to temple, brows to under the mouth
FACE_SIDE = 24
FACE_MODES, MODULE_MODES = 16, 12
SHRINKAGE = 0.02
VIEW_YAWS = (-24.0, 0.0, 24.0)
VIEW_REACH = 15.0  # degrees: neighbours overlap
MODULES = {  # patch width in interpupillary distances, patch size
    "pupil.L": (0.8, (16, 12)),
    "pupil.R": (0.8, (16, 12)),
    "nose": (0.9, (18, 14)),
    "mouth": (1.1, (22, 14)),
}


@dataclass(frozen=True)
class Samples:
    """Patches of one person's pictures."""

    faces: np.ndarray  # K x FACE_SIDE x FACE_SIDE
    yaws: np.ndarray  # K, degrees
    modules: list[np.ndarray]  # K x H x W each
    places: np.ndarray  # K x modules x 2, from the patch's middle, in its widths


def samples_of(seed: int) -> Samples:
    """What a person adds to the training; the same for the same seed."""
    person = Person(seed, load_template())
    rng = np.random.default_rng([seed, 72])
    pictures = [person.picture() for _ in range(PICTURES_A_PERSON)]
    faces, places = [], []
    modules: list[list] = [[] for _ in MODULES]
    for picture in pictures:
        # A search stops at steps of place and size: what it compares is never quite centred
        width = FACE_IPDS * PX_PER_IPD * np.exp(rng.uniform(-0.08, 0.08))
        middle = _middle(picture) + rng.uniform(-0.02, 0.02, 2) * width
        faces.append(_cut(picture.grey, middle, width, (FACE_SIDE, FACE_SIDE), rng))
        places.append((picture.places - middle) / width)
        for patches, place, (ipds, size) in zip(
            modules, picture.places, MODULES.values(), strict=True
        ):
            scale = np.exp(rng.uniform(-0.08, 0.08))
            patches.append(_cut(picture.grey, place, scale * ipds * PX_PER_IPD, size, rng))
    yaws = np.array([picture.yaw for picture in pictures])
    return Samples(np.array(faces), yaws, [np.array(m) for m in modules], np.array(places))


def eigenspaces(people: int, jobs: int, report: Callable[[str], None]) -> Eigenspaces:
    """The model of this many people, with as many processes as `jobs`."""
    made = []
    seeds = range(FIRST_SEED, FIRST_SEED + people)
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        for samples in pool.imap(samples_of, seeds, chunksize=4):
            made.append(samples)
            if len(made) % 50 == 0:
                report(f"{len(made)} of {people} people drawn")
    faces = np.concatenate([m.faces for m in made])
    yaws = np.concatenate([m.yaws for m in made])
    views = [
        train(faces[np.abs(yaws - at) <= VIEW_REACH], FACE_MODES, SHRINKAGE) for at in VIEW_YAWS
    ]
    places = np.concatenate([m.places for m in made])
    modules = []
    for i, (name, (ipds, _)) in enumerate(MODULES.items()):
        space = train(np.concatenate([m.modules[i] for m in made]), MODULE_MODES, SHRINKAGE)
        modules.append(_core.FaceModule(name, space, ipds / FACE_IPDS, places[:, i].mean(0)))
    covariance = np.cov(places.reshape(len(places), -1).T) + 1e-5 * np.eye(2 * len(MODULES))
    return Eigenspaces(views, list(VIEW_YAWS), modules, covariance)


def _middle(picture: Picture) -> np.ndarray:
    return (picture.places[:2].mean(0) + picture.places[3]) / 2


def _cut(
    grey: np.ndarray,
    middle: np.ndarray,
    width: float,
    size: tuple[int, int],
    rng: np.random.Generator,
) -> np.ndarray:
    """A patch of `size` (width, height) round a pixel, smoothed and noisy as a camera's, uint8."""
    half = np.array([width, width * size[1] / size[0]]) / 2
    low, high = middle + 0.5 - half, middle + 0.5 + half
    image = Image.fromarray(grey.astype(np.float32))
    patch = image.resize(size, Image.Resampling.BILINEAR, box=(*low, *high))
    noisy = np.asarray(patch) + rng.normal(0, rng.uniform(0.5, 4), patch.size[::-1])
    return np.clip(np.round(noisy), 0, 255).astype(np.uint8)
