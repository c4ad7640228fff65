# SPDX-License-Identifier: GPL-3.0-or-later
import dataclasses
import shutil

import numpy as np
from smiling import smiling
from strip_pixels import strip_colours

FRAMES = 90
LOOKED_AT = {20: {"good"}, 36: {"good"}, 37: {"lost"}, 42: {"lost"}, 48: {"lost"}, 49: {"good"}}


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
    settings = {"extension": extension.name, "frames": FRAMES, "looked_at": list(LOOKED_AT)}
    result = folder.walk(screen, "walk_takes.py", work, pictures, settings, seconds=600)
    assert not result.failures()
    for kind in ("TIMELINE", "DOPESHEET", "FCURVES"):
        seen = strip_colours(result.pictures[f"strip-{kind}"], result.arrays[f"strip-{kind}"])
        assert seen == list(LOOKED_AT.values()), kind
    without = strip_colours(result.pictures["strip-off"], result.arrays["strip-FCURVES"])
    assert without == [set()] * len(LOOKED_AT)
    assert {"takes", "curves", "takes-compared", "takes-blended"} <= set(result.pictures)
