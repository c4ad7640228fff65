# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws everybody once and keeps the pictures in the cache."""

from __future__ import annotations

import hashlib
import multiprocessing
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from .people import Person

FIRST_SEED = 1000  # people of evaluation/stills have seeds below
FRONTS, BACKS = 8, 2  # pictures a person
ROOT = Path(__file__).resolve().parents[3]
SOURCES = (
    Path(__file__).with_name("people.py"),
    *(
        ROOT / "evaluation" / "synthetic" / name
        for name in ("scene.py", "person.py", "texture.py", "noise.py")
    ),
    ROOT / "evaluation" / "synthetic" / "stills" / "sitters.py",
)


@dataclass(frozen=True)
class Pictures:
    """Drawn people, K pictures."""

    grey: np.ndarray  # K x SIDE x SIDE, uint8
    places: np.ndarray  # K x 4 x 2, pixels
    yaw: np.ndarray  # K, degrees

    @property
    def fronts(self) -> np.ndarray:
        return np.flatnonzero(np.abs(self.yaw) < 90)

    @property
    def backs(self) -> np.ndarray:
        return np.flatnonzero(np.abs(self.yaw) >= 90)


def pictures_of(seed: int) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """A person's pictures as (grey, places, yaw); the same for the same seed."""
    person = Person(seed, load_template())
    pictures = [person.picture() for _ in range(FRONTS)]
    pictures += [person.picture(behind=True) for _ in range(BACKS)]
    return [(picture.grey, picture.places, picture.yaw) for picture in pictures]


def drawn_pictures(people: int, jobs: int, cache: Path, report: Callable[[str], None]) -> Pictures:
    """Everybody's pictures, drawn unless the cache has them."""
    path = cache / f"people-{people}-{_key()}.npz"
    if not path.exists():
        pictures: list = []
        with multiprocessing.get_context("spawn").Pool(jobs) as pool:
            seeds = range(FIRST_SEED, FIRST_SEED + people)
            for count, rows in enumerate(pool.imap(pictures_of, seeds, chunksize=2), 1):
                pictures += rows
                if count % 50 == 0:
                    report(f"{count} of {people} people drawn")
        grey, places, yaw = (np.stack(column) for column in zip(*pictures, strict=True))
        cache.mkdir(parents=True, exist_ok=True)
        aside = cache / f".{path.name}"
        np.savez(aside, grey=grey, places=places, yaw=yaw)
        aside.replace(path)
    with np.load(path, allow_pickle=False) as arrays:
        return Pictures(arrays["grey"], arrays["places"], arrays["yaw"])


def _key() -> str:
    digest = hashlib.sha256()
    for source in (*SOURCES, data_folder() / "face.npz"):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
