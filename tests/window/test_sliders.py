# SPDX-License-Identifier: GPL-3.0-or-later
import shutil
import subprocess

VIEW = "700x640+50+80"  # between the toolbar and the sidebar


def test_sliders_and_overlays_show_on_a_face(folder, screen, extension, work, pictures):
    shutil.copy(extension, work)
    result = folder.walk(
        screen, "walk_sliders.py", work, pictures, {"extension": extension.name}, seconds=400
    )
    assert not result.failures()
    plain = result.pictures["sliders"]
    for name in ("muscles", "strain", "muscles-and-strain", "muscles-reloaded"):
        assert pixels_that_differ(plain, result.pictures[name]) > 5_000, name
    # Switched off, nothing of them is left
    assert pixels_that_differ(plain, result.pictures["sliders-again"]) < 500


def pixels_that_differ(picture, other) -> int:
    """Pixels of the 3D view that differ by more than a hundredth, by ImageMagick."""
    views = [f"{path}[{VIEW}]" for path in (picture, other)]
    compare = ["compare", "-metric", "AE", "-fuzz", "1%", *views, "null:"]
    ran = subprocess.run(compare, capture_output=True, text=True, check=False)
    assert ran.returncode < 2, ran.stderr
    return int(float(ran.stderr.split()[0]))
