# SPDX-License-Identifier: GPL-3.0-or-later
"""Times the finder with a face, without one and near a known place, and the fit."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic import _core
from mimetic.fit.fitting import find_face, landmark_places, refit
from mimetic.locate.eigenspaces import installed_spaces
from mimetic.media.footage import Footage
from mimetic.score.luminance import GREY
from mimetic.shared.installed_data import data_folder

from evaluation.runs.finders import CASCADES

CLIP = Path(__file__).resolve().parents[3] / "build" / "footage" / "single_face.mp4"
FRAME = 10
ROUNDS = 15


def pictures() -> tuple[np.ndarray, np.ndarray]:
    """480 x 640 x 3 uint8: a frame of a person between black bars, and blots that are no faces."""
    frame = Footage(CLIP).read(FRAME)
    with_face = np.zeros((480, 640, 3), np.uint8)
    with_face[60:420] = frame
    coarse = np.random.default_rng(0).integers(0, 255, (12, 16, 3))
    return with_face, coarse.repeat(40, axis=0).repeat(40, axis=1).astype(np.uint8)


def time_of(run: Callable[[], object]) -> tuple[float, float]:
    """Medians in milliseconds, by the clock and of all processors."""
    run()
    times = []
    for _ in range(ROUNDS):
        start, processor_start = time.perf_counter(), time.process_time()
        run()
        times.append((time.perf_counter() - start, time.process_time() - processor_start))
    by_clock, processor_start = 1000 * np.median(times, axis=0)
    return by_clock, processor_start


def main() -> int:
    face, nobody = pictures()
    grey = np.round(face @ GREY).astype(np.uint8)
    spaces = installed_spaces()
    locator = _core.FaceLocator(str(data_folder()), spaces=spaces)
    finder = _core.FaceFinder(spaces)
    face_before = finder.find(grey)[0]
    haar = _core.CascadeDetector(str(data_folder() / CASCADES["Haar cascade"]))
    fit = find_face(face)
    pin = {"mouth_corner.L": landmark_places(fit)["mouth_corner.L"]}
    runs = {
        "find a face (target: under 150)": lambda: locator.locate(face),
        "find that there is none (under 150)": lambda: locator.locate(nobody),
        "find it near its last place (under 15)": lambda: finder.find_near(grey, face_before),
        "Haar cascade alone": lambda: haar.detect(face),
        "find and fit": lambda: find_face(face),
        "fit again with a pin (under 50)": lambda: refit(fit, pin),
    }
    print(f"640 x 480 pixels, medians of {ROUNDS} in ms: by the clock, of all processors")
    for name, run in runs.items():
        by_clock, by_processor = time_of(run)
        print(f"{name:40} {by_clock:8.1f} {by_processor:8.1f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
