# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits the network of what covers a face to people who are drawn already; needs JAX.

usage: python -m scripts.build.occlusion.fit PEOPLE_FOLDER OUT_FOLDER

Every tenth person is held out; how well what covers these is seen is printed.
"""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import sys
import time
from pathlib import Path

import numpy as np

from ..eyes_and_lips.crops import Shots
from .pictures import sample

VARIANTS, ROUNDS = 10, 14
HELD_OUT = 10  # every tenth
SEED = 9
FACE, COVERED, BARE = 0.5, 0.8, 0.02  # shares of a cell from which, or below which, it counts


def samples_of(path: str) -> tuple[np.ndarray, ...]:
    """Pictures (K x S x S x 3) of one person, covered shares and shares of face (K x C x C)."""
    with np.load(path, allow_pickle=False) as arrays:
        shots = Shots(**arrays)
    rng = np.random.default_rng([int(Path(path).stem), SEED])
    made = [sample(shots, shot, rng) for shot in range(len(shots.frames)) for _ in range(VARIANTS)]
    return tuple(np.stack(part) for part in zip(*made, strict=True))


def samples(paths: list[Path]) -> tuple[np.ndarray, ...]:
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        rows = pool.map(samples_of, [str(path) for path in paths], chunksize=1)
    return tuple(np.concatenate(part) for part in zip(*rows, strict=True))


def main(folder: str, out: str) -> None:
    from . import onnx_file, training

    start = time.monotonic()

    def report(line: str) -> None:
        print(f"{time.monotonic() - start:5.0f} s  {line}", flush=True)

    paths = sorted(Path(folder).glob("*.npz"))
    held_out = paths[HELD_OUT - 1 :: HELD_OUT]
    pictures, covered, face = samples([path for path in paths if path not in held_out])
    report(f"{len(pictures)} pictures of {len(paths) - len(held_out)} people")
    weights = training.trained(pictures, covered, face, ROUNDS, SEED, report)
    tried, true, of_face = samples(held_out)
    seen = training.predicted(weights, tried)
    for name, which in (("covered", true > COVERED), ("bare", true < BARE)):
        share = (seen[(of_face > FACE) & which] > 0.5).mean()
        report(f"{name} cells of people held out that are said to be covered: {share:.3f}")
    path = Path(out) / "occlusion.onnx"
    onnx_file.write(weights, path)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    path.with_suffix(".sha256").write_text(f"{digest}  {path.name}\n", encoding="ascii")
    report(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main(*sys.argv[1:])
