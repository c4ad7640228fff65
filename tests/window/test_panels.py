# SPDX-License-Identifier: GPL-3.0-or-later
"""Every panel draws in a window. What is photographed is kept for scripts/panel_pictures."""

import json
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from mimetic.performance.document import Performance

FRAMES = 50


def test_every_panel_draws_and_is_photographed(
    folder, screen, extension, rendered_clip, work, pictures
):
    shutil.copy(extension, work)
    # Of a drawn person: its pictures may be in the manual
    shutil.copy(rendered_clip.footage, work / "actor.mp4")
    settings = {
        "extension": extension.name,
        "clip": "actor.mp4",
        "takes": takes_of(work / "actor.mp4"),
    }
    result = folder.walk(screen, "walk_panels.py", work, pictures, settings, seconds=600)
    assert not result.failures()
    names = result.arrays.pop("panels")
    assert len(names) >= 12
    assert {f"panel-{name.removeprefix('MIMETIC_PT_')}" for name in names} <= set(result.arrays)
    assert set(result.arrays) <= set(result.pictures)
    (pictures / "panels.json").write_text(json.dumps(result.arrays), encoding="utf-8")


def takes_of(clip: Path) -> list[str]:
    """A capture, and the same with the face lost for a while."""
    capture = [sys.executable, "-m", "mimetic", "capture", clip, "--frames", f"1:{FRAMES}"]
    subprocess.run([*capture, "--out", clip.parent / "take"], check=True, capture_output=True)
    path = clip.parent / "take" / "performance.npz"
    take = Performance.load(path)
    path.rename(clip.parent / "take_2.npz")
    quality = np.where(np.arange(FRAMES) // 9 == 4, 0.1, take.quality)
    replace(take, quality=quality).save(clip.parent / "take_1.npz")
    return ["take_2.npz", "take_1.npz"]
