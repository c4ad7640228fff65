# SPDX-License-Identifier: GPL-3.0-or-later
"""Every redo panel, by the screen's own mouse and keys, in one Blender."""

import dataclasses
import json
import os
import shutil
import subprocess

import numpy as np
from mimetic.library.expression import Expression
from mimetic.library.folder import Library
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.solve import clip_capture
from smiling import smiling

FRAMES, CAPTURED = 30, 12


def test_every_redo_panel_gives_what_a_call_does(folder, screen, extension, clip, work, pictures):
    shutil.copy(extension, work)
    takes(work)
    captured_clip(clip, work)
    for name, muscle in (("first", "frontalis_middle"), ("second", "zygomaticus_major")):
        expressions(work / name, name, muscle)
        rows = [{"control": "jawOpen", "gain": 0.5, "highest": 0.3 if name == "first" else 0.6}]
        (work / f"{name}.json").write_text(
            json.dumps({"format": "mimetic controls 1", "controls": rows})
        )
    only = os.environ.get("MIMETIC_REDO_ONLY", "").split()
    settings = {"extension": extension.name, "only": only, "pictured": only or ["bake"]}
    beside = ("undoing.py", "redo_panels.py", "redo_scenes.py", "redo_table.py")
    way = {"seconds": 900, "is_simulated": False}
    way["beside"] = (*beside, "../blender/scene_state.py")
    result = folder.walk(screen, "walk_redo.py", work, pictures, settings, **way)
    for name, seconds in result.arrays["seconds"]:
        print(f"{name:24} {seconds:6.1f} s")
    assert not result.failures()


def takes(work) -> None:
    """Three of one face, of which each was lost for a while elsewhere."""
    hero = smiling(FRAMES)
    for name, share, lost in (("hero", 1.0, 5), ("again", 0.4, 10), ("third", 0.7, 15)):
        quality = np.full(FRAMES, 0.9)
        quality[lost : lost + 3] = 0.1
        take = dataclasses.replace(hero, activations=share * hero.activations, quality=quality)
        take.save(work / f"{name}.npz")


def captured_clip(clip, work) -> None:
    path = work / "clip.mp4"
    cut = [ffmpeg_program(), "-v", "error", "-i", clip, "-c", "copy", "-frames:v"]
    subprocess.run([*cut, str(CAPTURED), path], check=True)
    fit = clip_capture.find_face(path, 3)
    clip_capture.capture(path, (1, CAPTURED), fit).save(work / "take.npz")


def expressions(folder, name: str, muscle: str) -> None:
    channels = [f"{muscle}.L", f"{muscle}.R"]
    values = np.outer(np.sin(np.linspace(0, np.pi, 26)) ** 2, (0.8, 0.4))
    events = np.array([[5.0, 12.5, 15.0, 0.8]])
    origin = ["clip.mp4", "1 to 26"]
    kept = Expression(channels, values, 0 * values, 25.0, ["lips"], events, origin)
    library = Library(folder)
    library.check_new(name)
    library.keep(name, kept, np.zeros((8, 8, 4), np.uint8))
