# SPDX-License-Identifier: GPL-3.0-or-later
import dataclasses
import shutil

import numpy as np
from smiling import smiling

FRAMES = 90


def test_takes_and_curves_are_worked_on_in_a_window(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    smile = smiling(FRAMES)
    smile.save(work / "hero.performance.npz")
    weak = dataclasses.replace(
        smile,
        activations=0.4 * smile.activations,
        quality=np.where(np.arange(90) // 12 == 3, 0.1, 0.9),
    )
    weak.save(work / "again.performance.npz")
    settings = {"extension": extension.name, "frames": FRAMES}
    result = folder.walk(screen, "walk_takes.py", work, pictures, settings, seconds=600)
    assert not result.failures()
    assert {"takes", "curves", "takes-compared", "takes-blended"} <= set(result.pictures)
