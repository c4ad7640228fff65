# SPDX-License-Identifier: GPL-3.0-or-later
import importlib.util
import os
import re
import subprocess
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from clips import make_clip
from mimetic._core import from_rotation_vectors
from mimetic.commands import cli
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.report.head_drawing import write_motion_plot
from mimetic.report.html import write_report
from mimetic.report.overlay import FaceDrawing, write_overlay
from mimetic.report.plots import GROUPS, head_angle_stds, head_angles
from mimetic.solve.capture_summary import CaptureSummary
from sample_fit import make_fit
from sample_performance import make_performance


@pytest.fixture
def footage(tmp_path):
    return Footage(make_clip(tmp_path / "clip.mp4", size="320x240", frames=12, rate="24000/1001"))


def test_capture_without_matplotlib_tells_before_any_work(monkeypatch, tmp_path, capsys):
    find_spec = importlib.util.find_spec
    monkeypatch.setattr(
        importlib.util,
        "find_spec",
        lambda name, *rest: None if name == "matplotlib" else find_spec(name, *rest),
    )
    assert cli.main(["capture", str(tmp_path / "clip.mp4"), "--out", str(tmp_path / "out")]) == 2
    assert "mimetic[report]" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_report_needs_no_other_file_and_says_what_was_found(tmp_path, footage):
    performance = make_performance(notes=["cut at frame 7 <here>"])
    summary = CaptureSummary(seconds={"decode": 0.5, "follow the face": 1.5}, fit=make_fit())
    write_report(performance, footage, tmp_path / "report.html", summary)
    text = (tmp_path / "report.html").read_text()
    addresses = re.findall(r"(?:src|href|url)\s*[=(]\s*['\"]?([^'\"\s>)]+)", text)
    assert addresses and all(address.startswith("data:image/") for address in addresses)
    assert "http" not in re.sub(r"data:[^']*", "", text)
    assert "clip.mp4" in text and "follow the face" in text and "numpy" in text
    assert "Frame 4 is taken as rest: the face looks most at rest there, and 11 of the 16" in text
    assert "cut at frame 7 &lt;here&gt;" in text
    assert text.count("data:image/jpeg") == 6 and text.count("data:image/png") == 3
    assert not list(tmp_path.glob(".*"))


def test_every_group_has_its_panel(footage):
    from mimetic.report.plots import _muscle_figure

    figure = _muscle_figure(make_performance())
    titles = [axes.get_title() for axes in figure.axes]
    for group, name in GROUPS.items():
        assert f"{group}  {name}" in titles
    drawn = sum(len(axes.lines) for axes in figure.axes)
    assert drawn == 36 + len(GROUPS) + 8  # a line at 1 in each panel


def test_every_held_frame_is_shaded_also_a_single_one():
    from mimetic.report.plots import _head_figure

    quality = np.ones(12)
    quality[[2, 6, 7, 8]] = 0.1
    turn = _head_figure(make_performance(quality=quality)).axes[1]
    bounds = [(patch.get_x(), patch.get_x() + patch.get_width()) for patch in turn.patches]
    assert bounds == [(2.5, 3.5), (6.5, 9.5)]


def test_head_angles_are_the_turns_that_were_made():
    pose = np.tile(np.diag([1.0, -1, -1, 1]), (12, 1, 1))
    pose[:, 2, 3] = 0.7
    c, s = np.cos(0.2), np.sin(0.2)
    down = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])  # nose (head z) towards head -y
    right = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])  # nose towards head x, the image's right
    pose[1, :3, :3] = pose[1, :3, :3] @ down
    pose[2, :3, :3] = pose[2, :3, :3] @ right
    clockwise = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])  # head y towards head x
    pose[3, :3, :3] = pose[3, :3, :3] @ clockwise
    angles = head_angles(make_performance(head_pose=pose))
    degrees = np.degrees(0.2)
    np.testing.assert_allclose(angles[0], 0, atol=1e-9)
    np.testing.assert_allclose(angles[1], [degrees, 0, 0], atol=1e-9)
    np.testing.assert_allclose(angles[2], [0, degrees, 0], atol=1e-9)
    np.testing.assert_allclose(angles[3], [0, 0, degrees], atol=1e-9)


@pytest.fixture
def turned():
    """A head that is turned far, known well about one axis and badly about another."""
    c, s = np.cos(1.0), np.sin(1.0)
    right = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    tilt = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    pose = np.tile(np.diag([1.0, -1, -1, 1]), (12, 1, 1))
    pose[:6, :3, :3] = pose[:6, :3, :3] @ right
    pose[6:11, :3, :3] = tilt @ pose[6:11, :3, :3] @ right
    pose[11, :3, :3] = tilt @ pose[11, :3, :3]
    pose[:, 2, 3] = 0.7
    covariance = np.diag(np.radians([1, 0.5, 0.2, 0, 0, 0]) ** 2)
    covariance[0, 1] = covariance[1, 0] = 0.5 * np.radians(1) * np.radians(0.5)
    return make_performance(head_pose=pose, head_pose_cov=np.tile(covariance, (12, 1, 1)))


def test_deviations_of_head_angles_are_those_of_the_angles_themselves(turned):
    random = np.random.default_rng(5)
    pose, covariance = turned.head_pose, turned.head_pose_cov[0, :3, :3]
    draws = []
    for error in random.multivariate_normal(np.zeros(3), covariance, 4000):
        turn = from_rotation_vectors(error[None])[0]
        drawn = pose.copy()
        drawn[:, :3, :3] = turn @ pose[:, :3, :3]
        draws.append(head_angles(SimpleNamespace(head_pose=drawn)))
    np.testing.assert_allclose(head_angle_stds(turned), np.std(draws, axis=0), rtol=0.06)


def test_bands_of_head_angles_are_their_deviations(turned, tmp_path, monkeypatch):
    from matplotlib.axes import Axes
    from mimetic.report.plots import _head_figure

    bands = []

    def fill_between(panel, x, low, high=0, **style):
        bands.append((np.asarray(high) - low) / 2)

    monkeypatch.setattr(Axes, "fill_between", fill_between)
    _head_figure(turned)
    stds = head_angle_stds(turned)
    np.testing.assert_allclose(np.array(bands[1:4]).T, stds)  # after the quality's
    bands.clear()
    write_motion_plot(turned, tmp_path / "motion.png")
    np.testing.assert_allclose(np.array(bands[:3]).T, stds)


def test_the_overlay_has_the_footages_frames_and_rate(tmp_path, footage):
    performance = make_performance(frame=np.arange(12) + 1)
    assert write_overlay(performance, footage, tmp_path / "overlay.mp4")
    overlay = Footage(tmp_path / "overlay.mp4")
    assert overlay.fps == footage.fps and overlay.num_frames == 12
    assert overlay.size == (960, 720)  # small footage is enlarged
    plain, drawn = footage.read(1), overlay.read(1)
    middle = drawn[340:380, 460:500].astype(int) - plain[118:122, 158:162].mean()
    assert np.abs(middle).max() > 40


def test_the_overlay_states_its_colours_and_keeps_the_footages(tmp_path, footage):
    write_overlay(make_performance(), footage, tmp_path / "overlay.mp4")
    command = [ffmpeg_program(), "-hide_banner", "-i", tmp_path / "overlay.mp4"]
    report = subprocess.run(command, stderr=subprocess.PIPE, text=True).stderr
    assert re.search(r"yuv420p\(tv, bt709(,|\))", report)  # matrix, primaries and transfer alike
    plain, drawn = footage.read(1), Footage(tmp_path / "overlay.mp4").read(1)
    enlarged = np.repeat(np.repeat(plain, 3, axis=0), 3, axis=1)
    assert np.median(np.abs(drawn.astype(float) - enlarged)) < 4


def test_the_overlay_of_a_part_has_the_part(tmp_path, footage):
    performance = make_performance(num_frames=5, frame=np.arange(5) + 4)
    assert write_overlay(performance, footage, tmp_path / "overlay.mp4")
    assert Footage(tmp_path / "overlay.mp4").num_frames == 5


def test_a_stopped_overlay_leaves_no_file(tmp_path, footage):
    before = set(tmp_path.iterdir())
    stop_at = iter([True, True, False])
    assert not write_overlay(
        make_performance(), footage, tmp_path / "overlay.mp4", lambda *_: next(stop_at)
    )
    assert set(tmp_path.iterdir()) == before


def test_the_mesh_is_drawn_where_the_face_is():
    drawing = FaceDrawing(make_performance())
    black = np.zeros((240, 320, 3), np.uint8)
    picture = drawing.paint(black, 0)
    lit = np.argwhere(picture[: 720 - 60].max(axis=2) > 60)
    pixels = drawing.performance.project(drawing.performance.surface_in_camera(0))
    low, high = 3 * pixels.min(axis=0)[::-1] - 3, 3 * pixels.max(axis=0)[::-1] + 6
    assert len(lit) > 500
    assert (lit >= low).all() and (lit <= high).all()


def test_a_name_that_is_no_text_breaks_no_report(tmp_path):
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xe9t\xe9 \xff.mp4"))
    os.rename(make_clip(tmp_path / "clip.mp4", size="320x240", frames=12), path)
    performance = make_performance(notes=[f"{path.name} is odd \ud800"])
    performance.save(tmp_path / "p.npz")
    again = Performance.load(tmp_path / "p.npz")
    write_report(again, Footage(path), tmp_path / "report.html", CaptureSummary())
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "udce9" in text and "ud800" in text


def test_muscles_that_are_not_told_apart_are_hatched_and_named(tmp_path, footage):
    from mimetic.report.plots import _muscle_figure

    of = np.full((12, 36), -1)
    of[3:9, 4], of[3:9, 7] = 7, 4
    activations = np.zeros((12, 36))
    activations[3:9, 4] = 0.5
    performance = make_performance(confounded_with=of, activations=activations)
    hatched = [
        part
        for axes in _muscle_figure(performance).axes
        for part in axes.collections
        if part.get_hatch() and len(part.get_paths())
    ]
    assert [part.get_datalim(part.axes.transData).intervalx.tolist() for part in hatched] == [
        [3.5, 9.5]
    ] * 2
    write_report(performance, footage, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text()
    assert "Not told apart: muscle_02.L and muscle_03.R (6 frames)." in text
