# SPDX-License-Identifier: GPL-3.0-or-later
"""The Open Job Description template, checked and run by the specification's own tool."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from mimetic.batch import open_job, plan
from mimetic.batch.clip_list import Row
from mimetic.batch.steps import Settings
from mimetic.batch.task import Task

OPENJD = Path(sys.executable).with_name("openjd")
MIMETIC = Path(sys.executable).with_name("mimetic")


def openjd(*words):
    ran = subprocess.run([OPENJD, *map(str, words)], capture_output=True, text=True, check=False)
    return ran.returncode, ran.stdout + ran.stderr


@pytest.fixture
def prepared(tmp_path):
    """A batch of so many clips that are none."""

    def prepare(count):
        rows = []
        for number in range(count):
            path = tmp_path / f"clip {number} é.mp4"
            path.write_bytes(b"no video")
            rows.append(Row(str(path)))
        (tmp_path / "out").mkdir()
        return plan.prepare(tmp_path / "out", rows, Settings())

    return prepare


def test_the_template_is_valid(prepared):
    path = open_job.write_template(prepared(3), "mimetic")
    status, text = openjd("check", path)
    assert status == 0, text
    status, text = openjd("summary", path)
    assert status == 0 and "Clips 1" in text and "3" in text


def test_a_step_has_no_more_tasks_than_it_may(prepared, monkeypatch):
    monkeypatch.setattr(open_job, "MOST_VALUES", 2)
    path = open_job.write_template(prepared(5), "mimetic")
    steps = json.loads(path.read_text())["steps"]
    ranges = [s["parameterSpace"]["taskParameterDefinitions"][0]["range"] for s in steps]
    assert [len(names) for names in ranges] == [2, 2, 1] and len(set().union(*ranges)) == 5
    assert openjd("check", path)[0] == 0


def test_a_clip_that_fails_fails_its_task_by_exit_status(prepared):
    batch = prepared(1)
    path = open_job.write_template(batch, str(MIMETIC))
    status, text = openjd("run", path, "--step", "Clips 1")
    assert status != 0 and "is cut off before its index" in text, text
    assert Task.load(batch.tasks[0].folder).error


def test_its_tasks_give_the_bytes_that_one_machine_gives(resumed, clips, mimetic, tmp_path):
    shutil.copy(clips / "one.mp4", tmp_path)
    out = tmp_path / "out"
    ran = mimetic(
        *("batch", tmp_path / "one.mp4", "--out", out, "--submit", "openjd", "--mimetic", MIMETIC)
    )
    assert ran.returncode == 0 and "deadline bundle submit" in ran.stdout, ran.stderr
    assert not (out / "one" / "performance.npz").exists()
    template = out / "template.json"
    for _ in range(2):  # it does nothing the second time
        status, text = openjd("run", template, "--step", "Clips 1")
        assert status == 0, text
    for name in ("performance.npz", "fit.json", "overlay.mp4"):
        assert (out / "one" / name).read_bytes() == (resumed[0] / "one" / name).read_bytes()
    assert mimetic("batch", "--summary", "--out", out).returncode == 0
