# SPDX-License-Identifier: GPL-3.0-or-later
"""A few frames of real people, and a batch of them."""

import json
import subprocess
import sys
import time

import pytest
from clips import ffmpeg, make_clip
from sample_fit import make_fit

MIMETIC = [sys.executable, "-m", "mimetic"]


@pytest.fixture(scope="session")
def mimetic():
    """Runs a command line; gives the process that ended."""

    def run(*words, **options):
        command = [*MIMETIC, *map(str, words)]
        return subprocess.run(command, capture_output=True, text=True, check=False, **options)

    return run


def task_of(folder):
    path = folder / "task.json"
    return json.loads(path.read_text()) if path.exists() else {"done": {}}


@pytest.fixture(scope="session")
def clips(fetched_clip, tmp_path_factory):
    """Two people, and all that can be wrong with clips."""
    folder = tmp_path_factory.mktemp("clips")
    for name, footage in (("one", "single_face.mp4"), ("two", "cap13_edit2.mp4")):
        ffmpeg("-i", fetched_clip(footage), "-frames:v", 4, "-crf", 10, folder / f"{name}.mp4")
    make_clip(folder / "faceless.mp4", size="160x120", frames=4)
    (folder / "damaged.mp4").write_bytes((folder / "one.mp4").read_bytes()[:3000])
    make_fit().save(folder / "large.json")
    return folder


@pytest.fixture(scope="session")
def resumed(clips, mimetic, tmp_path_factory):
    """A batch that was killed after its first clip, and started again: (folder, its run)."""
    out = tmp_path_factory.mktemp("batch") / "out"
    table = out.parent / "table.csv"
    table.write_text(f"clip,fit\n{clips / 'two.mp4'},{clips / 'large.json'}\n")
    words = ["batch", clips, table, clips.parent / "gone.mp4", "--out", out, "--processes", "1"]
    first = out / "one"
    order = [*MIMETIC, *map(str, words)]
    batch = subprocess.Popen(order, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while "capture" not in task_of(first)["done"] and batch.poll() is None:
        time.sleep(0.1)
    batch.kill()
    batch.wait()
    before = (first / "performance.npz").stat().st_mtime_ns
    ran = mimetic(*words)
    assert (first / "performance.npz").stat().st_mtime_ns == before
    return out, ran
