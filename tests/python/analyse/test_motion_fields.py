# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion fields: flow of the footage beside the surface's motion in the picture and in space."""

import csv

import numpy as np
import pytest
from clips import ffmpeg, make_clip
from mimetic.analyse.comparison_report import FILES, MOTION_FILES
from mimetic.commands.cli import main
from mimetic.template.face_template import load_template
from test_comparison import FRAMES, RELEASED, moved_by

SHIFT = (0.5, -0.25)  # pixels a frame that the whole picture moves by


@pytest.fixture(scope="module")
def performance():
    """A smile by an action unit, its head still."""
    one = moved_by(load_template(), "AU12")
    one.head_pose[:] = one.head_pose[0]
    return one


@pytest.fixture(scope="module")
def gliding(tmp_path_factory):
    """Smooth noise of the performance's size that glides evenly."""
    rng = np.random.default_rng(3)
    y, x = np.mgrid[:240, :320].astype(float)
    waves = rng.normal(0, 0.25, (40, 2)), rng.uniform(0, 6, 40)
    frames = []
    for n in range(FRAMES):
        across, down = x - n * SHIFT[0], y - n * SHIFT[1]
        field = sum(np.sin(a * across + b * down + p) for (a, b), p in zip(*waves, strict=True))
        frames.append(np.clip(128 + 14 * field, 0, 255).astype(np.uint8).tobytes())
    path = tmp_path_factory.mktemp("clip") / "gliding.mp4"
    ffmpeg(
        *("-f", "rawvideo", "-pix_fmt", "gray", "-s", "320x240", "-r", "24000/1001", "-i", "-"),
        *("-c:v", "libx264", "-qp", "4", "-pix_fmt", "yuv420p", path),
        feed=b"".join(frames),
    )
    return path


def test_flow_is_the_pictures_and_the_rest_the_performances(performance, gliding, tmp_path):
    performance.save(tmp_path / "p.npz")
    out = tmp_path / "out"
    command = ["compare", str(tmp_path / "p.npz"), "--out", str(out), "--footage", str(gliding)]
    assert main(command) == 0
    assert {path.name for path in out.iterdir()} == {*FILES, *MOTION_FILES}
    with open(out / "comparison.csv", newline="") as stream:
        [event] = csv.DictReader(stream)
    first, peak = int(event["first_frame"]), int(event["peak_frame"])
    table = np.genfromtxt(out / "motion.csv", delimiter=",", names=True)
    assert len(table) > 100
    steps = peak - first
    flow = np.column_stack([table["flow_x"], table["flow_y"]])
    np.testing.assert_allclose(np.median(flow, axis=0), np.multiply(SHIFT, steps), atol=0.4)
    # In space as the surface moves; in the picture as that is projected
    moved = performance.surface(peak - 1) - performance.surface(first - 1)
    vertices = table["vertex"].astype(int)
    in_space = np.column_stack([table[f"space_{axis}_mm"] for axis in "xyz"])
    np.testing.assert_allclose(in_space, 1000 * moved[vertices], atol=1e-3)
    start = performance.project(performance.surface_in_camera(first - 1))[vertices]
    end = performance.project(performance.surface_in_camera(peak - 1))[vertices]
    on_picture = np.column_stack([table["surface_x"], table["surface_y"]])
    np.testing.assert_allclose(on_picture, end - start, atol=1e-4)
    assert np.abs(in_space).max() > 3


def test_what_is_there_at_first_is_followed_back_from_its_release(gliding, tmp_path):
    one = moved_by(load_template(), "AU12", course=RELEASED)
    one.head_pose[:] = one.head_pose[0]
    one.save(tmp_path / "p.npz")
    out = tmp_path / "out"
    command = ["compare", str(tmp_path / "p.npz"), "--out", str(out), "--footage", str(gliding)]
    assert main([*command, "--event", "1"]) == 0
    with open(out / "comparison.csv", newline="") as stream:
        [event] = csv.DictReader(stream)
    steps = int(event["peak_frame"]) - int(event["rest_frame"])
    assert steps < -15
    table = np.genfromtxt(out / "motion.csv", delimiter=",", names=True)
    flow = np.column_stack([table["flow_x"], table["flow_y"]])
    np.testing.assert_allclose(np.median(flow, axis=0), np.multiply(SHIFT, steps), atol=0.4)
    assert np.abs(table["space_x_mm"]).max() > 3


@pytest.mark.parametrize(
    ("size", "frames", "reason"), [("64x48", 50, "of 64 x 48"), ("320x240", 15, "ends before")]
)
def test_other_footage_is_refused_in_one_line(performance, tmp_path, capsys, size, frames, reason):
    performance.save(tmp_path / "p.npz")
    clip = make_clip(tmp_path / "other.mp4", size=size, frames=frames)
    out = tmp_path / "out"
    command = ["compare", str(tmp_path / "p.npz"), "--out", str(out), "--footage", str(clip)]
    assert main(command) == 2
    text = capsys.readouterr().err
    assert reason in text and text.count("mimetic:") == 1
    assert not list(out.iterdir())
