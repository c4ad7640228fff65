# SPDX-License-Identifier: GPL-3.0-or-later
import dataclasses
import shutil

from smiling import smiling

FRAMES = 45  # one smile


def test_blenders_own_tools_work_on_what_was_baked(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    hero = smiling(FRAMES)
    hero.save(work / "hero.npz")
    dataclasses.replace(hero, activations=0.4 * hero.activations).save(work / "again.npz")
    settings = {"extension": extension.name, "frames": FRAMES}
    way = {"seconds": 300, "is_simulated": False}
    way["beside"] = ("undoing.py", "redo_panels.py", "../blender/scene_state.py")
    result = folder.walk(screen, "walk_ordinary_tools.py", work, pictures, settings, **way)
    assert not result.failures()
