# SPDX-License-Identifier: GPL-3.0-or-later
import shutil
import subprocess
import sys

FRAME = 20


def test_a_baked_file_opens_in_a_view_that_shows_it(folder, screen, clip, work, pictures):
    """No extension is installed: the file shows its face to anybody."""
    mimetic = [sys.executable, "-m", "mimetic"]
    shutil.copy(clip, work)
    footage, taken = work / clip.name, work / "take"
    capture = [*mimetic, "capture", footage, "--frames", f"1:{FRAME + 10}", "--out", taken]
    subprocess.run(capture, check=True, capture_output=True)
    bake = [*mimetic, "bake", taken / "performance.npz", "--footage", footage]
    subprocess.run([*bake, "--out", work / "face.blend"], check=True, capture_output=True)
    settings = {"frame": FRAME}
    result = folder.walk(screen, "walk_opened.py", work, pictures, settings, seconds=200)
    assert not result.failures()
