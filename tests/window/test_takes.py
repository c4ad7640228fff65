# SPDX-License-Identifier: GPL-3.0-or-later
import dataclasses
import shutil

import numpy as np
from matplotlib.image import imread
from smiling import smiling
from strip_pixels import strip_colours

FRAMES = 90
# About the curve at -.3, -.1, .1 and .3, of which its error bars of .2 hold the inner two
WITH_BARS = {12: "told apart", 40: "lost", 60: "not told apart"}
LOOKED_AT = {20: {"good"}, 36: {"good"}, 37: {"lost"}, 42: {"lost"}, 48: {"lost"}, 49: {"good"}}


def test_takes_and_curves_are_worked_on_in_a_window(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    smile = smiling(FRAMES)
    smile.save(work / "hero.performance.npz")
    lips = [smile.muscles.index(name) for name in ("zygomaticus_major.L", "risorius.L")]
    not_told_apart = np.full(smile.activations.shape, -1)
    not_told_apart[np.ix_(range(50, 70), lips)] = lips[::-1]
    weak = dataclasses.replace(
        smile,
        activations=0.4 * smile.activations,
        activations_std=np.full(smile.activations.shape, 0.12),
        quality=np.where(np.arange(90) // 12 == 3, 0.1, 0.9),
        confounded_with=not_told_apart,
    )
    weak.save(work / "again.performance.npz")
    settings = {"extension": extension.name, "frames": FRAMES, "looked_at": list(LOOKED_AT)}
    settings["with_bars"] = list(WITH_BARS)
    result = folder.walk(screen, "walk_takes.py", work, pictures, settings, seconds=600)
    assert not result.failures()
    for kind in ("TIMELINE", "DOPESHEET", "FCURVES"):
        seen = strip_colours(result.pictures[f"strip-{kind}"], result.arrays[f"strip-{kind}"])
        assert seen == list(LOOKED_AT.values()), kind
    without = strip_colours(result.pictures["strip-off"], result.arrays["strip-FCURVES"])
    assert without == [set()] * len(LOOKED_AT)
    # Normalized the curve fills the editor: what lies above its top is not seen
    for name, shown in (("error-bars", 4), ("error-bars-normalized", 2)):
        changed = changed_pixels(result.pictures, name, result.arrays[name])
        held = [False, True, True, False][:shown]
        assert changed["told apart"][:shown] == held, name
        assert changed["lost"][:shown] == [False] * shown, name
        assert changed["not told apart"][:shown] == held, name
    assert {"takes", "curves", "takes-compared", "takes-blended"} <= set(result.pictures)


def changed_pixels(pictures: dict, name: str, places: list) -> dict[str, list[bool]]:
    """Where error bars are drawn beside the curve; those that are not told apart are orange."""
    shown, off = (imread(pictures[one])[::-1, :, :3] for one in (name, f"{name}-off"))
    rows, columns = shown.shape[:2]
    inside = np.clip(np.round(places).astype(int), 0, [columns - 1, rows - 1])
    colours = [(shown[y, x], off[y, x]) for x, y in inside]
    changed = [bool(np.abs(one - other).max() > 0.02) for one, other in colours]
    kinds = list(WITH_BARS.values())
    orange = colours[4 * kinds.index("not told apart") + 1][0]
    assert orange[0] > orange[1] + 0.1 > orange[2] + 0.2, orange
    return {kind: changed[4 * k : 4 * k + 4] for k, kind in enumerate(kinds)}
