# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic batch` as its users run it, on a few frames of real people."""

import json
import os
import re
import resource
import shutil

import pytest
from clips import make_clip
from mimetic.batch import plan
from mimetic.batch.clip_list import Row
from mimetic.batch.steps import Settings
from mimetic.batch.task import run_task
from mimetic.commands.cli import main
from stand_in import Commands


def test_a_killed_batch_goes_on_where_it_was(resumed):
    out, ran = resumed
    assert ran.returncode == 1, ran.stderr
    for name in ("one", "two"):
        assert "capture" in json.loads((out / name / "task.json").read_text())["done"]
        assert (out / name / "overlay.mp4").is_file()
        assert list((out / name).glob(".mimetic*")) == []


def test_every_failure_is_a_line_at_the_end(resumed):
    _, ran = resumed
    *lines, last = ran.stdout.splitlines()
    reasons = dict(line.split(": ", 1) for line in lines)
    assert "no frontal face" in reasons["faceless"]
    assert "cut off before its index" in reasons["damaged"]
    assert any("no such file" in reason for reason in reasons.values()) and len(reasons) == 4
    assert "the face fit is for pictures of 320 x 240" in reasons["two-2"]
    assert re.search(r"2 clips done, 1 of them before, 4 not; index.html", last)


def test_the_page_shows_every_clip_and_needs_nothing_else(resumed):
    out, _ = resumed
    page = (out / "index.html").read_text()
    for name in ("one", "two", "faceless", "damaged", "gone.mp4"):
        assert f"<h3>{name}</h3>" in page
    assert page.count("src='data:image/jpeg") == 2 and page.count("<polyline") == 2
    assert "no frontal face" in page and "href='one/report.html'" in page
    assert not re.search(r"(src|href)='(https?:|//|/)", page)


def test_a_task_gives_the_bytes_that_the_command_gives(mimetic, resumed, clips, tmp_path):
    out, _ = resumed
    assert mimetic("capture", clips / "one.mp4", "--out", tmp_path).returncode == 0
    for name in ("performance.npz", "fit.json", "overlay.mp4"):
        assert (tmp_path / name).read_bytes() == (out / "one" / name).read_bytes(), name


def test_a_summary_is_told_without_running_anything(mimetic, resumed):
    out, _ = resumed
    (out / "index.html").unlink()
    ran = mimetic("batch", "--summary", "--out", out)
    assert ran.returncode == 1 and "2 clips done, 4 not" in ran.stdout
    assert (out / "index.html").is_file()


def test_a_full_disk_fails_the_clip_and_says_so(mimetic, clips, tmp_path):
    """A limit of a file's size stands for the disk: a performance is larger."""
    shutil.copy(clips / "two.mp4", tmp_path)
    ran = mimetic(
        *("batch", tmp_path / "two.mp4", clips / "faceless.mp4", "--out", tmp_path / "out"),
        *("--retries", "0"),
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000)),
        env={**os.environ, "TMPDIR": str(tmp_path)},
    )
    assert ran.returncode == 1
    assert "performance.npz: File too large" in ran.stdout and "0 clips done, 2 not" in ran.stdout
    assert not (tmp_path / "out" / "two" / "performance.npz").exists()


def test_a_batch_of_nothing_and_settings_that_cannot_be_are_bad_input(mimetic, tmp_path):
    ran = mimetic("batch", "--out", tmp_path)
    assert ran.returncode == 2 and "give the clips" in ran.stderr
    no_text = ["--blender-python", os.fsdecode(b"python-\xff")]
    of_no_object = ["--character", str(tmp_path / "rig.blend")]
    wrong = (["--processes", "0"], ["--frames", "9:2"], ["--few-keys", "7"], of_no_object, no_text)
    for words in wrong:
        ran = mimetic("batch", tmp_path / "a.mp4", "--out", tmp_path / "out", *words)
        assert ran.returncode == 2 and ran.stderr.count("\n") == 1, ran.stderr
    assert "--blender-python" in ran.stderr and not list((tmp_path / "out").glob("*/*"))
    assert mimetic("batch", "--task", "../x", "--out", tmp_path).returncode == 2


@pytest.fixture
def prepared(tmp_path):
    """The folder of a batch of one clip, `a`, in which nothing is done."""
    clip = make_clip(tmp_path / "a.mp4", size="320x240", frames=12)
    (tmp_path / "out").mkdir()
    plan.prepare(tmp_path / "out", [Row(str(clip))], Settings())
    return tmp_path / "out"


def test_a_clip_whose_results_are_of_other_settings_is_not_done_yet(prepared, capsys):
    run_task(prepared / "a", Commands())
    words = ["batch", "--summary", "--out", str(prepared)]
    assert main(words) == 0
    assert "1 clip done; index.html shows it\n" in capsys.readouterr().out
    assert "<b>1</b><span>clip done</span>" in (prepared / "index.html").read_text()
    plan.prepare(prepared, [Row(str(prepared.parent / "a.mp4"), focal="50")], Settings())
    assert main(words) == 1
    said = capsys.readouterr().out
    assert "a: not done yet" in said and "0 clips done, 1 not" in said
    page = (prepared / "index.html").read_text()
    assert "<p>not done yet</p>" in page and "href='a/report.html'" in page


@pytest.mark.parametrize("words", [["--task", "a"], []])
def test_a_step_that_there_is_not_and_steps_of_no_task_are_refused(prepared, words, capsys):
    steps = "captrue" if words else "capture"
    assert main(["batch", *words, "--out", str(prepared), "--steps", steps]) == 2
    said = capsys.readouterr().err
    assert ("choose from" in said and "character" in said) if words else "--task NAME" in said


def test_a_task_that_there_is_not_is_refused_and_nothing_is_left_in_its_place(prepared, capsys):
    (prepared / "b").mkdir()
    for name in "bc":
        assert main(["batch", "--task", name, "--out", str(prepared)]) == 2
        assert f"--task {name}: the batch in {prepared} has a: give" in capsys.readouterr().err
    assert not list((prepared / "b").iterdir()) and not (prepared / "c").exists()
    assert main(["batch", "--task", "a", "--out", str(prepared.parent / "none")]) == 2


def test_the_page_and_the_summary_are_of_all_batches_that_are_at_work(prepared, capsys):
    clip = make_clip(prepared.parent / "b.mp4", size="160x120", frames=4)
    words = ["batch", "--out", str(prepared), "--retries", "0"]
    with plan.begun(prepared, [Row(str(prepared.parent / "a.mp4"))], Settings()):
        assert main([*words, str(clip)]) == 1
    own = capsys.readouterr().out
    assert "b: " in own and "0 clips done, 1 not" in own and "a: " not in own
    page = (prepared / "index.html").read_text()
    assert "<h3>a</h3>" in page and "<h3>b</h3>" in page
    assert main([*words, "--summary"]) == 1
    told = capsys.readouterr().out
    assert "a: not done yet" in told and "0 clips done, 2 not" in told
    assert (prepared / "index.html").read_text() == page
    assert main(["batch", "--summary", "--out", str(prepared / "none")]) == 2
    assert "there is no such file" in capsys.readouterr().err
