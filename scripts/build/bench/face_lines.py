# SPDX-License-Identifier: GPL-3.0-or-later
"""Times the lines of a captured face, as the clip editor draws them, beside the surface alone."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from mimetic.library.composing import canonical_person
from mimetic.performance.document import Performance
from mimetic.report.face_lines import PerformanceLines

FRAMES = 200


def acting() -> Performance:
    """The canonical head with all muscles at work, turning from side to side."""
    rest = canonical_person()
    random = np.random.default_rng(1)
    poses = np.repeat(rest.head_pose, FRAMES, axis=0)
    for pose, angle in zip(poses, np.radians(np.linspace(-40, 40, FRAMES)), strict=True):
        c, s = np.cos(angle), np.sin(angle)
        pose[:3, :3] = pose[:3, :3] @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    return replace(
        rest,
        frame=np.arange(1, FRAMES + 1),
        head_pose=poses,
        head_pose_cov=np.repeat(rest.head_pose_cov, FRAMES, axis=0),
        activations=random.uniform(0, 0.5, (FRAMES, len(rest.muscles))),
        activations_std=np.repeat(rest.activations_std, FRAMES, axis=0),
        articulator_values=np.repeat(rest.articulator_values, FRAMES, axis=0),
        quality=np.ones(FRAMES),
    )


def milliseconds(call: Callable[[int], object]) -> float:
    """The median of a frame."""
    times = []
    for i in range(FRAMES):
        start = time.perf_counter()
        call(i)
        times.append(time.perf_counter() - start)
    return 1000 * statistics.median(times)


def main() -> None:
    performance = acting()
    start = time.perf_counter()
    lines = PerformanceLines(performance)
    begun = 1000 * (time.perf_counter() - start)
    drawn, floor = milliseconds(lines.draw), milliseconds(performance.surface_in_camera)
    print(f"a take is made ready in {begun:.0f} ms")
    print(f"lines of a frame: {drawn:.2f} ms; the surface's vertices alone: {floor:.2f} ms")


if __name__ == "__main__":
    main()
