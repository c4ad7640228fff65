# SPDX-License-Identifier: GPL-3.0-or-later
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from clips import ffmpeg, make_clip
from imageio_ffmpeg import get_ffmpeg_exe
from mimetic import InvalidInput, UnreadableMedia
from mimetic._core import rotation_vectors
from mimetic.commands.cli import main
from mimetic.fit.fitting import FaceFit, NoFace
from mimetic.media.backward import frames_backward
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.solve import clip_capture, smoothing
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import capture, find_face


@pytest.fixture(scope="module")
def fit(rest_fit):
    return rest_fit


@pytest.fixture(scope="module")
def performance(captured_clip):
    return captured_clip


def test_the_whole_clip_is_captured_frame_by_frame(rendered_clip, performance):
    footage = Footage(rendered_clip.footage)
    assert performance.frame.tolist() == list(range(1, footage.num_frames + 1))
    assert performance.fps == float(footage.fps)
    assert tuple(performance.image_size) == footage.size
    assert np.median(performance.quality) > 0.5
    assert performance.notes is None or "stopped" not in " ".join(performance.notes)


def test_a_range_holds_those_frames_alone(rendered_clip, fit):
    part = capture(rendered_clip.footage, frames=(5, 9), fit=fit)
    assert part.frame.tolist() == [5, 6, 7, 8, 9]


def test_the_heads_turn_is_less_sure_the_further_it_is_from_the_fit(
    rendered_clip, fit, monkeypatch
):
    usual = capture(rendered_clip.footage, frames=(5, 9), fit=fit)
    monkeypatch.setattr(clip_capture, "TURN_ERROR", 0.0)
    of_the_flow = capture(rendered_clip.footage, frames=(5, 9), fit=fit)
    np.testing.assert_array_equal(usual.head_pose, of_the_flow.head_pose)
    turned = rotation_vectors(usual.head_pose[:, :3, :3] @ fit.head_pose[:3, :3].T)
    added = usual.head_pose_cov - of_the_flow.head_pose_cov
    variance = (0.02 * np.linalg.norm(turned, axis=1)) ** 2
    assert variance.max() > 1e-8
    np.testing.assert_allclose(
        added[:, :3, :3], variance[:, None, None] * np.eye(3), rtol=1e-4, atol=1e-12
    )


def test_frames_before_the_fits_are_captured_too(rendered_clip):
    late = find_face(rendered_clip.footage, 8)
    performance = capture(rendered_clip.footage, frames=(1, 12), fit=late)
    assert performance.frame.tolist() == list(range(1, 13))
    steps = np.linalg.norm(np.diff(performance.head_pose[:, :3, 3], axis=0), axis=1)
    assert steps.max() < 0.02  # metres a frame: no jump where the two ways meet


def test_the_summary_says_where_the_time_went(rendered_clip, fit):
    summary = CaptureSummary()
    capture(rendered_clip.footage, frames=(1, 4), fit=fit, summary=summary)
    assert {"decode", "attach the muscles", "follow the face", "smooth"} <= set(summary.seconds)
    assert all(seconds >= 0 for seconds in summary.seconds.values())


def test_a_stopped_capture_keeps_and_marks_what_is_done(rendered_clip, fit):
    calls = []

    def progress(fraction, text):
        calls.append((fraction, text))
        return len(calls) < 6

    kept = capture(rendered_clip.footage, fit=fit, progress=progress)
    assert 1 <= kept.num_frames <= 7
    assert np.all(np.diff(kept.frame) == 1)
    assert "stopped by the user" in kept.notes[-1] or "stopped by the user" in " ".join(kept.notes)
    assert all(0 <= fraction <= 1 for fraction, _ in calls)


def test_a_capture_stopped_at_once_keeps_nothing(rendered_clip, fit):
    with pytest.raises(UnreadableMedia, match="stopped too early"):
        capture(rendered_clip.footage, fit=fit, progress=lambda *_: False)


@pytest.mark.parametrize("word", ["refining", "factoring", "muscles"])
def test_a_capture_can_be_stopped_while_muscles_are_attached(rendered_clip, fit, word):
    texts = []

    def progress(_fraction, text):
        texts.append(text)
        return word not in text

    with pytest.raises(UnreadableMedia, match="stopped too early"):
        capture(rendered_clip.footage, fit=fit, progress=progress)
    assert word in texts[-1]


def test_windows_of_smoothing_join_without_a_seam(rendered_clip, fit, performance, monkeypatch):
    monkeypatch.setattr(smoothing, "WINDOW", 8)
    monkeypatch.setattr(smoothing, "OVERLAP", 12)
    parts = capture(rendered_clip.footage, fit=fit)
    np.testing.assert_array_equal(parts.frame, performance.frame)
    np.testing.assert_allclose(parts.activations, performance.activations, atol=0.02)
    np.testing.assert_allclose(parts.head_pose, performance.head_pose, atol=1e-3)


def test_frames_backward_are_the_same_frames(rendered_clip):
    footage = Footage(rendered_clip.footage)
    forward = dict(footage.frames(1, 9))
    backward = list(frames_backward(footage, 9, 1))
    assert [frame for frame, _ in backward] == list(range(9, 0, -1))
    for frame, image in backward:
        np.testing.assert_array_equal(image, forward[frame])


def test_no_face_is_said_with_what_to_do(tmp_path):
    clip = make_clip(tmp_path / "bars.mp4", size="320x240", frames=5, source="smptebars")
    with pytest.raises(NoFace, match=r"no frontal face.*--frames"):
        capture(clip)


def test_a_single_frame_shows_no_motion(rendered_clip, tmp_path):
    ffmpeg("-i", rendered_clip.footage, "-frames:v", "1", tmp_path / "one.mp4")
    with pytest.raises(InvalidInput, match="at least two"):
        capture(tmp_path / "one.mp4")


def test_a_clip_of_which_one_frame_can_be_read_shows_no_motion(rendered_clip, tmp_path, capsys):
    whole, part = tmp_path / "whole.mp4", tmp_path / "part.mp4"
    ffmpeg(
        *("-i", rendered_clip.footage, "-c:v", "libx264", "-g", "1", "-bf", "0"),
        *("-pix_fmt", "yuv420p", "-movflags", "+faststart", whole),
    )
    ffmpeg("-i", whole, "-frames:v", "1", "-c", "copy", "-f", "h264", tmp_path / "first.h264")
    content = whole.read_bytes()
    end = content.index(b"mdat") + 4 + (tmp_path / "first.h264").stat().st_size + 200
    part.write_bytes(content[:end])
    assert Footage(part).num_frames > 1 and len(list(Footage(part))) == 1
    for command in ("capture", "head"):
        assert main([command, str(part), "--out", str(tmp_path / "out")]) == 2
        assert "shows no motion" in capsys.readouterr().err
        assert not list((tmp_path / "out").iterdir())


def as_ffmpeg(tmp_path, monkeypatch, decoding):
    """ffmpeg as it is but where it decodes: there a line for the shell."""
    program = tmp_path / "ffmpeg-that-fails"
    program.write_text(
        f"#!/bin/sh\nffmpeg={get_ffmpeg_exe()}\n"
        f'case "$*" in *rawvideo*) {decoding};; *) exec $ffmpeg "$@";; esac\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(program))


def test_an_ffmpeg_without_memory_is_not_a_clip_without_a_face(
    rendered_clip, tmp_path, monkeypatch, capsys
):
    as_ffmpeg(tmp_path, monkeypatch, "kill -KILL $$")
    assert main(["fit", str(rendered_clip.footage), "--out", str(tmp_path / "out")]) == 1
    error = capsys.readouterr().err
    assert "out of memory" in error and "no frontal face" not in error


def test_frames_that_ffmpeg_gave_before_it_failed_are_kept(
    rendered_clip, fit, tmp_path, monkeypatch
):
    five = 5 * 320 * 240 * 3
    as_ffmpeg(tmp_path, monkeypatch, f'$ffmpeg "$@" | head -c {five}; kill -KILL $$')
    summary = CaptureSummary()
    kept = capture(rendered_clip.footage, frames=(fit.frame, 50), fit=fit, summary=summary)
    assert 2 <= kept.num_frames <= 6
    assert any("out of memory" in note for note in kept.notes)
    assert "out of memory" in summary.footage.failure.strerror


def test_a_frame_an_hour_is_captured(rendered_clip, fit, tmp_path):
    slow = tmp_path / "slow.nut"
    ffmpeg("-i", rendered_clip.footage, "-c", "copy", "-bsf:v", "setts=ts=TS*108000", slow)
    fit.save(tmp_path / "fit.json")
    words = ("capture", slow, "--out", tmp_path / "out", "--frames", "1:4")
    assert main([str(word) for word in (*words, "--fit", tmp_path / "fit.json")]) == 0
    assert Performance.load(tmp_path / "out" / "performance.npz").fps == pytest.approx(1 / 3600)
    assert Footage(tmp_path / "out" / "overlay.mp4").num_frames == 4


def test_a_fit_for_another_size_is_refused(rendered_clip, fit, tmp_path):
    clip = make_clip(tmp_path / "small.mp4", size="160x120", frames=5)
    with pytest.raises(InvalidInput, match="320 x 240"):
        capture(clip, fit=fit)


@pytest.mark.parametrize(
    ("frames", "reason"),
    [
        ((900, 910), "frames 900:910 of .*: it has frames 1 to 50"),
        ((900, None), "frames 900: of .*: it has frames 1 to 50"),
        ((5, 4), "5:4 of .*: the first is after the last"),
        ((0, 3), "frames 0:3 of .*: it has frames 1 to 50"),
    ],
)
def test_frames_outside_of_the_clip_are_refused(rendered_clip, frames, reason):
    with pytest.raises(InvalidInput, match=reason):
        capture(rendered_clip.footage, frames=frames)


def test_a_face_that_leaves_is_held_and_found_again(rendered_clip, tmp_path):
    bars = make_clip(
        tmp_path / "bars.mkv", "-c:v", "ffv1", size="320x240", frames=14, source="smptebars"
    )
    plain = "setpts=N/25/TB,format=yuv420p,setsar=1"
    filters = f"[0:v]trim=end_frame=10,{plain}[a];[1:v]{plain}[b];[0:v]{plain}[c];"
    ffmpeg(
        *("-i", rendered_clip.footage, "-i", bars),
        *("-filter_complex", filters + "[a][b][c]concat=n=3"),
        *("-c:v", "ffv1", tmp_path / "cut.mkv"),
    )
    first = find_face(rendered_clip.footage, 4)
    performance = capture(tmp_path / "cut.mkv", frames=(1, 50), fit=first)
    assert performance.frame.tolist() == list(range(1, 51))
    assert (performance.quality[:9] > 0.3).all()
    assert (performance.quality[13:23] < 0.2).all()
    still = performance.activations[13:23]
    assert np.abs(still - still[0]).max() < 0.05  # held, not invented
    assert (performance.quality[-10:] > 0.3).all()
    assert any("held" in note for note in performance.notes)


def test_of_two_faces_the_larger_is_taken_and_told(rendered_clip, tmp_path):
    both = tmp_path / "two.mkv"
    filters = "[0:v]scale=240:180,pad=240:240[a];[0:v][a]hstack"
    ffmpeg(*("-i", rendered_clip.footage, "-filter_complex", filters, "-c:v", "ffv1", both))
    performance = capture(both, frames=(14, 17))
    pixels = performance.project(performance.surface_in_camera(0))
    assert pixels[:, 0].mean() < 320
    assert any("2 faces" in note for note in performance.notes)


def run(*arguments):
    return [sys.executable, "-m", "mimetic", *(str(argument) for argument in arguments)]


def test_the_command_writes_everything_asked_for(rendered_clip, tmp_path):
    out = tmp_path / "new" / "folder"
    ran = subprocess.run(
        run("capture", rendered_clip.footage, "--out", out, "--frames", "1:10"),
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stderr
    names = {path.name for path in out.iterdir()}
    assert names == {"performance.npz", "overlay.mp4", "report.html", "fit.json"}
    assert Performance.load(out / "performance.npz").num_frames == 10
    assert Footage(out / "overlay.mp4").num_frames == 10
    assert FaceFit.load(out / "fit.json").image_size == (320, 240)


def test_a_fit_from_a_file_is_used(rendered_clip, fit, tmp_path):
    fit.save(tmp_path / "fit.json")
    words = (
        "capture",
        rendered_clip.footage,
        "--out",
        tmp_path / "out",
        "--frames",
        "1:3",
        "--fit",
    )
    assert main([str(word) for word in (*words, tmp_path / "fit.json")]) == 0
    again = FaceFit.load(tmp_path / "out" / "fit.json")
    np.testing.assert_allclose(again.head_pose, fit.head_pose)


@pytest.mark.usefixtures("hangup_heard")
@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_a_signal_keeps_the_finished_part(rendered_clip, fit, tmp_path, number, status):
    long = tmp_path / "long.mp4"
    ffmpeg("-stream_loop", "99", "-i", rendered_clip.footage, "-c", "copy", long)
    fit.save(tmp_path / "fit.json")
    words = ("capture", long, "--fit", tmp_path / "fit.json", "--out", tmp_path / "out")
    process = subprocess.Popen(run(*words), stderr=subprocess.PIPE, text=True)
    for _ in range(2):  # the first is shown before any frame is finished
        while "following the face" not in process.stderr.readline():
            assert process.poll() is None
    process.send_signal(number)
    _, errors = process.communicate(timeout=240)
    assert process.returncode == status, errors
    kept = Performance.load(tmp_path / "out" / "performance.npz")
    assert kept.num_frames < Footage(long).num_frames
    assert any("stopped by the user" in note for note in kept.notes)
    assert not list((tmp_path / "out").glob(".*"))


def test_ctrl_c_before_a_face_is_found_exits_130_and_leaves_nothing(tmp_path):
    bars = make_clip(tmp_path / "bars.mp4", size="640x480", frames=500, source="smptebars")
    process = subprocess.Popen(
        run("capture", bars, "--out", tmp_path / "out"), stderr=subprocess.PIPE, text=True
    )
    while not (tmp_path / "out").exists():
        time.sleep(0.02)
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130, errors
    assert not list((tmp_path / "out").iterdir())


@pytest.mark.parametrize("name", ["absent.mp4", "empty.mp4", "text.mp4"])
def test_bad_footage_is_one_line_and_status_2(tmp_path, capsys, name):
    if name != "absent.mp4":
        (tmp_path / name).write_bytes(b"" if name == "empty.mp4" else b"text " * 99)
    assert main(["capture", str(tmp_path / name), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert name in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_a_folder_that_cannot_be_written_is_told_before_any_work(rendered_clip, tmp_path, capsys):
    (tmp_path / "file").touch()
    assert main(["capture", str(rendered_clip.footage), "--out", str(tmp_path / "file")]) == 2
    assert "is a file" in capsys.readouterr().err
    if os.geteuid() != 0:
        (tmp_path / "closed").mkdir(mode=0o500)
        out = str(tmp_path / "closed" / "out")
        assert main(["capture", str(rendered_clip.footage), "--out", out]) == 2
        assert "written to" in capsys.readouterr().err


def test_a_file_in_the_way_of_the_folder_is_named(tmp_path, rendered_clip, capsys):
    (tmp_path / "file").touch()
    assert main(["capture", str(rendered_clip.footage), "--out", str(tmp_path / "file" / "x")]) == 2
    assert "--out" in capsys.readouterr().err


def test_unreadable_media_is_an_os_error():
    assert issubclass(UnreadableMedia, OSError) and issubclass(NoFace, ValueError)
