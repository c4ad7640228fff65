# SPDX-License-Identifier: GPL-3.0-or-later
"""Points followed by MediaPipe's face mesh, which runs in a process and environment of its own."""

from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from numpy.typing import NDArray

from evaluation.runs.rendered import CHECKOUT


def mesh_tracks(
    images: list[NDArray[np.uint8]], start: NDArray[np.float64], python: Path
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Tracks (N,K,2) and points (N,K,3, metres, its own head frame; nan beside the mesh).

    start: pixels (K,2) of the first image; python: of scripts/face_mesh_env. None where it finds no
    face in the first image; a frame without a face repeats the one before. Raises InvalidInput.
    """
    with tempfile.TemporaryDirectory() as folder:
        frames, pixels, out = (Path(folder) / name for name in ("f.npy", "p.npy", "out.npz"))
        np.save(frames, np.stack(images))
        np.save(pixels, start)
        script = CHECKOUT / "evaluation" / "synthetic" / "expressions" / "face_mesh_points.py"
        command = [str(word) for word in (python, script, frames, pixels, out)]
        process = subprocess.run(command, capture_output=True, text=True, check=False)
        if process.returncode != 0:
            raise InvalidInput(f"the face mesh failed: {' '.join(process.stderr.split()[-40:])}")
        if not out.exists():
            return None
        with np.load(out, allow_pickle=False) as arrays:
            return arrays["tracks"], arrays["points"]
