# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws everybody once and keeps the shots in the cache."""

from __future__ import annotations

import hashlib
import multiprocessing
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from mimetic.locate.landmarks import landmark_points
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from scripts.build.eigenspaces.pictures import SOURCES as PEOPLE_SOURCES

from .sitters import Shot, Sitter

FIRST_SEED = 2000  # nobody else has people of such seeds
SHOTS = 10  # a person


@dataclass(frozen=True)
class Shots:
    """K shots of everybody, one person after another; fields as in `sitters.Shot`."""

    grey: np.ndarray  # K x SIDE x SIDE, uint8
    places: np.ndarray  # K x L x 2
    pupils: np.ndarray  # K x 2 x 2
    yaw: np.ndarray  # K, degrees

    @classmethod
    def of(cls, shots: list[Shot]) -> Shots:
        return cls(*(np.stack([getattr(one, f.name) for one in shots]) for f in fields(cls)))


def shots_of(seed: int) -> list[Shot]:
    """A person's shots; the same for the same seed."""
    sitter = Sitter(seed, load_template())
    return [sitter.shot() for _ in range(SHOTS)]


def drawn_shots(people: int, jobs: int, cache: Path, report: Callable[[str], None]) -> Shots:
    """Everybody's shots, drawn unless the cache has them."""
    path = cache / f"shots-{people}-{_key()}.npz"
    if not path.exists():
        all_shots: list[Shot] = []
        with multiprocessing.get_context("spawn").Pool(jobs) as pool:
            seeds = range(FIRST_SEED, FIRST_SEED + people)
            for count, shots in enumerate(pool.imap(shots_of, seeds, chunksize=2), 1):
                all_shots += shots
                if count % 50 == 0:
                    report(f"{count} of {people} people drawn")
        cache.mkdir(parents=True, exist_ok=True)
        aside = cache / f".{path.name}"
        np.savez(aside, **vars(Shots.of(all_shots)))
        aside.replace(path)
    with np.load(path, allow_pickle=False) as arrays:
        return Shots(*(arrays[field.name] for field in fields(Shots)))


def _key() -> str:
    digest = hashlib.sha256()
    own = Path(__file__).with_name("sitters.py")
    for source in (*PEOPLE_SOURCES, own, data_folder() / "face.npz"):
        digest.update(source.read_bytes())
    digest.update(" ".join(landmark_points(load_template())[0]).encode())
    return digest.hexdigest()[:16]
