# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of one run appear together or not at all, whoever else writes and whatever ends it."""

import argparse
import os
import resource
import signal
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from clips import make_clip
from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.capture import COSTS, write_pictures
from mimetic.commands.on_clip import run_on_clip
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.report.overlay import NoFrames, _encode, write_overlay
from mimetic.shared.results import publish, staging
from sample_performance import make_performance

FOUR = ["fit.json", "overlay.mp4", "performance.npz", "report.html"]


@pytest.fixture
def clip(tmp_path):
    return make_clip(tmp_path / "clip.mp4", size="320x240", frames=12, rate="24000/1001")


def a_fit():
    pose = np.diag([1.0, -1, -1, 1])
    pose[2, 3] = 0.7
    return FaceFit(
        1, (320, 240), np.array([[400.0, 0, 159.5], [0, 400, 119.5], [0, 0, 1]]), pose, {}
    )


def run(clip, out, num_frames=12, draw=write_pictures, meanwhile=lambda: None, person=None):
    """The capture command with a following that needs no time; returns its status."""

    def follow(_fit, _progress, summary):
        meanwhile()
        summary.fit = a_fit()
        return make_performance(num_frames=num_frames)

    arguments = argparse.Namespace(
        **dict.fromkeys(("frames", "fit", "face", "rest", "focal", "sensor")),
        person=person,
        footage=clip,
        out=out,
    )
    return run_on_clip(arguments, COSTS, follow, draw)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def send(number):
    return lambda: os.kill(os.getpid(), number)


def test_two_overlays_into_one_folder_are_both_whole(tmp_path, clip):
    footage, path = Footage(clip), tmp_path / "overlay.mp4"
    others = iter([make_performance(num_frames=5)])

    def meanwhile(*_):
        for other in others:
            assert write_overlay(other, footage, path)
            assert Footage(path).num_frames == 5
        return True

    assert write_overlay(make_performance(), footage, path, meanwhile)
    assert Footage(path).num_frames == 12
    assert names(tmp_path) == ["clip.mp4", "overlay.mp4"]


def test_two_captures_into_one_folder_end_well_and_leave_results_of_one(tmp_path, clip):
    out = tmp_path / "out"

    def draw(*arguments):
        assert run(clip, out, num_frames=5) == 0
        assert names(out)[1:] == FOUR  # before them the folder of the one that is at work
        assert Performance.load(out / "performance.npz").num_frames == 5
        assert Footage(out / "overlay.mp4").num_frames == 5
        write_pictures(*arguments)

    assert run(clip, out, draw=draw) == 0
    assert names(out) == FOUR
    assert Performance.load(out / "performance.npz").num_frames == 12
    assert Footage(out / "overlay.mp4").num_frames == 12


@pytest.mark.usefixtures("hangup_heard")
@pytest.mark.parametrize(
    ("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_a_stopped_run_keeps_its_part_and_replaces_nothing(tmp_path, clip, capfd, number, status):
    out = tmp_path / "out"
    assert run(clip, out) == 0
    before = {name: (out / name).read_bytes() for name in names(out)}
    for name in ("unfinished", "unfinished-2"):
        assert run(clip, out, num_frames=3, meanwhile=send(number)) == status
        assert Performance.load(out / name / "performance.npz").num_frames == 3
        assert names(out / name) == ["fit.json", "performance.npz", "report.html"]
        message = capfd.readouterr().err
        assert str(out / name) in message and "results that were there before" in message
    assert {name: (out / name).read_bytes() for name in FOUR} == before
    assert names(out) == [*FOUR, "unfinished", "unfinished-2"]


def test_what_is_stopped_first_is_kept_where_it_was_asked_for(tmp_path, clip):
    assert run(clip, tmp_path / "out", num_frames=3, meanwhile=send(signal.SIGTERM)) == 143
    assert names(tmp_path / "out") == ["fit.json", "performance.npz", "report.html"]


def test_a_second_signal_leaves_all_as_it_was(tmp_path, clip):
    out = tmp_path / "out"
    assert run(clip, out, num_frames=4) == 0
    before = {name: (out / name).read_bytes() for name in FOUR}

    def twice():
        send(signal.SIGTERM)()
        send(signal.SIGTERM)()

    with pytest.raises(KeyboardInterrupt) as request:
        run(clip, out, meanwhile=twice)
    assert request.value.status == 143
    assert {name: (out / name).read_bytes() for name in names(out)} == before


def test_a_finished_run_takes_the_earlier_ones_pictures_along(tmp_path, clip):
    out = tmp_path / "out"
    assert run(clip, out) == 0
    (out / "mine.txt").write_text("stays")

    def motion_alone(_performance, _footage, folder, *_):
        (folder / "motion.png").write_bytes(b"new")

    assert run(clip, out, num_frames=4, draw=motion_alone) == 0
    assert names(out) == ["fit.json", "mine.txt", "motion.png", "performance.npz"]


def test_a_target_in_the_way_is_told_before_the_work(tmp_path, clip):
    (tmp_path / "out" / "report.html").mkdir(parents=True)
    with pytest.raises(UnreadableMedia, match=r"report\.html is a folder"):
        run(clip, tmp_path / "out", meanwhile=lambda: pytest.fail("it worked"))
    with pytest.raises(ValueError, match=r"overlay\.mp4 is what is read"):
        (tmp_path / "again").mkdir()
        os.link(clip, tmp_path / "again" / "overlay.mp4")
        run(tmp_path / "again" / "overlay.mp4", tmp_path / "again")


def test_what_cannot_be_published_leaves_the_earlier_results(tmp_path):
    (tmp_path / "a").write_bytes(b"old")
    (tmp_path / "b").mkdir()
    with pytest.raises(UnreadableMedia, match="b is a folder"), staging(tmp_path) as folder:
        (folder / "a").write_bytes(b"new")
        (folder / "b").write_bytes(b"new")
        publish(folder, tmp_path, is_finished=True)
    assert names(tmp_path) == ["a", "b"] and (tmp_path / "a").read_bytes() == b"old"


STAGE = """
import sys, time
from pathlib import Path
from mimetic.shared.results import staging
with staging(Path(sys.argv[1])) as folder:
    (folder / "half").write_text("half")
    print(folder, flush=True)
    time.sleep(60)
"""


def test_the_folder_of_a_killed_run_goes_with_the_next_and_of_one_at_work_stays(tmp_path):
    child = subprocess.Popen([sys.executable, "-c", STAGE, tmp_path], stdout=subprocess.PIPE)
    at_work = child.stdout.readline().decode().strip()
    with staging(tmp_path) as folder:
        assert {str(path) for path in tmp_path.iterdir()} == {at_work, str(folder)}
    child.kill()
    child.wait()
    assert [str(path) for path in tmp_path.iterdir()] == [at_work]
    with staging(tmp_path) as folder:
        assert list(tmp_path.iterdir()) == [folder]
    assert names(tmp_path) == []


def test_a_full_disk_while_drawing_keeps_the_capture(tmp_path, clip, capfd):
    out = tmp_path / "out"

    def fill(*arguments):
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
        try:
            write_pictures(*arguments)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))

    with pytest.raises(OSError, match="ffmpeg could not write it") as failure:
        run(clip, out, draw=fill)
    assert failure.value.filename == str(out / "overlay.mp4")
    assert names(out) == ["fit.json", "performance.npz"]
    assert "performance.npz; 12 frames" in capfd.readouterr().err


@pytest.mark.parametrize("becomes", [None, b"another file"])
def test_footage_that_goes_before_it_is_drawn_over_is_a_failure(tmp_path, clip, capfd, becomes):
    out = tmp_path / "out"
    assert run(clip, out) == 0
    before = {name: (out / name).read_bytes() for name in FOUR}

    def meanwhile():
        clip.unlink()
        if becomes:
            clip.write_bytes(becomes)

    with pytest.raises(OSError, match="replaced" if becomes else "went away") as failure:
        run(clip, out, meanwhile=meanwhile)
    assert failure.value.filename == str(clip) and not isinstance(failure.value, UnreadableMedia)
    assert names(out / "unfinished") == ["fit.json", "performance.npz"]
    assert {name: (out / name).read_bytes() for name in FOUR} == before
    assert "results that were there before" in capfd.readouterr().err


def test_an_overlay_without_a_picture_is_a_failure_and_no_file(tmp_path, clip):
    late = replace(make_performance(), frame=np.arange(101, 113))
    with pytest.raises(NoFrames, match="none of the frames 101 to 112 can be read"):
        write_overlay(late, Footage(clip), tmp_path / "overlay.mp4")
    assert names(tmp_path) == ["clip.mp4"]


def test_the_person_that_is_read_is_not_replaced(tmp_path, clip):
    out = tmp_path / "out"
    assert run(clip, out) == 0
    before = (out / "fit.json").read_bytes()
    with pytest.raises(InvalidInput, match=r"fit\.json is what is read; give another folder"):
        run(clip, out, person=out / "fit.json")
    assert (out / "fit.json").read_bytes() == before


def test_an_overlay_on_a_full_disk_says_so(tmp_path):
    (tmp_path / "full.mp4").symlink_to("/dev/full")
    pictures = iter([np.zeros((64, 64, 3), np.uint8)] * 30)
    with pytest.raises(OSError, match="No space left on device"):
        _encode(pictures, tmp_path / "full.mp4", Fraction(25), "overlay.mp4")


def test_a_disk_full_before_the_performance_is_saved_keeps_it_elsewhere(
    tmp_path, clip, capfd, monkeypatch
):
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "elsewhere"))
    save = Performance.save

    def full(self, path):
        if path.is_relative_to(tmp_path / "out"):
            raise OSError(28, "No space left on device", str(path))
        save(self, path)

    monkeypatch.setattr(Performance, "save", full)
    with pytest.raises(OSError, match="No space") as failure:
        run(clip, tmp_path / "out")
    assert failure.value.filename == str(tmp_path / "out" / "performance.npz")
    (kept,) = (tmp_path / "elsewhere").glob("*/performance.npz")
    assert str(kept) in capfd.readouterr().err
    assert Performance.load(kept).num_frames == 12
    assert names(tmp_path / "out") == []


SAVE = """
import sys
from mimetic.commands import cli
from sample_performance import make_performance
cli.COMMANDS["save"] = ("save", "saves")
class Save:
    add_arguments = staticmethod(lambda parser: None)
    run_save = staticmethod(lambda arguments: make_performance(num_frames=60).save("p.npz"))
sys.modules["save"] = Save
sys.exit(cli.main(["save"]))
"""


@pytest.mark.parametrize("largest", [10, 3000, 30_000])
def test_a_performance_on_a_full_disk_is_one_line_with_the_path(tmp_path, largest):
    ran = subprocess.run(
        [sys.executable, "-c", SAVE],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.path.dirname(os.path.dirname(__file__))},
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (largest, largest)),
    )
    assert (ran.returncode, ran.stderr) == (1, "mimetic: p.npz: File too large\n")
    assert names(tmp_path) == []


def test_a_full_disk_is_one_line_with_the_path(tmp_path):
    make_performance(num_frames=60).save(tmp_path / "p.npz")
    (tmp_path / "at.csv").write_text("x,y\n" + "150.5,100.25\n" * 4000)
    words = ["points", "p.npz", "--at", "at.csv", "--out", "t.npz"]
    ran = subprocess.run(
        [sys.executable, "-m", "mimetic", *words],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (3000, 3000)),
    )
    assert (ran.returncode, ran.stderr) == (1, "mimetic: t.npz: File too large\n")
    assert names(tmp_path) == ["at.csv", "p.npz"]
