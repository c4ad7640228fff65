# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits the regressors to people who are drawn already; runs in an environment with JAX.

usage: python -m eyes_and_lips.fit PEOPLE_FOLDER OUT_FOLDER PART ...

Every tenth person is held out; the errors on these are printed, in % of the square's side.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from .crops import Shots, sample

# Of each part: which squares (0 left eye, 1 right eye, 2 mouth), pictures of each, rounds
PARTS = {"eye": ((0, 1), 4, 24), "mouth": ((2,), 8, 24)}
HELD_OUT = 10  # every tenth
SEED = 7


def samples_of(job: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """All pictures (K x 64 x 64 x 3) of a part of one person, and their points (K x P x 2)."""
    path, part = job
    with np.load(path, allow_pickle=False) as arrays:
        shots = Shots(**arrays)
    squares, variants, _ = PARTS[part]
    rng = np.random.default_rng([int(Path(path).stem), SEED])
    made = [
        sample(shots, shot, square, rng)
        for shot in range(len(shots.frames))
        for square in squares
        for _ in range(variants)
    ]
    pictures, points = zip(*made, strict=True)
    return np.stack(pictures), np.stack(points)


def samples(paths: list[Path], part: str) -> tuple[np.ndarray, np.ndarray]:
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        rows = pool.map(samples_of, [(str(path), part) for path in paths], chunksize=4)
    pictures, points = zip(*rows, strict=True)
    return np.concatenate(pictures), np.concatenate(points)


def fit(part: str, folder: Path, out: Path, report: Callable[[str], None]) -> None:
    from . import onnx_file, training

    paths = sorted(folder.glob("*.npz"))
    held_out = paths[HELD_OUT - 1 :: HELD_OUT]
    pictures, points = samples([path for path in paths if path not in held_out], part)
    report(f"{part}: {len(pictures)} pictures of {len(paths) - len(held_out)} people")
    which = training.EYE if part == "eye" else training.MOUTH
    weights = training.trained(which, pictures, points, PARTS[part][2], SEED, report)
    tried, true = samples(held_out, part)
    off = 100 * np.abs(training.predicted(weights, which, tried) - true)
    for group in range(which.num_groups):
        of_group = off[:, np.array(which.groups) == group]
        report(
            f"{part}: group {group}: {np.median(of_group[..., 0]):.2f} across the picture, "
            f"{np.median(of_group[..., 1]):.2f} down"
        )
    path = out / f"{part}_points.onnx"
    onnx_file.write(weights, path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    path.with_suffix(".sha256").write_text(f"{digest}  {path.name}\n", encoding="ascii")
    report(f"{path}: {path.stat().st_size} bytes")


def main(folder: str, out: str, *parts: str) -> None:
    start = time.monotonic()

    def report(line: str) -> None:
        print(f"{time.monotonic() - start:5.0f} s  {line}", flush=True)

    for part in parts:
        fit(part, Path(folder), Path(out), report)


if __name__ == "__main__":
    main(*sys.argv[1:])
