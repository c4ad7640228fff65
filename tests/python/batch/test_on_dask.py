# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch on a real scheduler and real workers, processes of their own, one of them killed."""

import os
import shutil
import signal
import subprocess
import sys
import time

import pytest

PROGRAM = [sys.executable, "-m"]
QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


@pytest.fixture
def cluster(tmp_path):
    """Address of a scheduler, and its two workers by process."""
    file = tmp_path / "scheduler.json"
    order = [*PROGRAM, "distributed.cli.dask_scheduler", "--no-dashboard", "--port", "0"]
    order += ["--host", "127.0.0.1", "--scheduler-file", file]
    processes = [subprocess.Popen(order, cwd=tmp_path, **QUIET)]
    while not file.exists() or not file.read_text().strip():
        time.sleep(0.1)
    order = [*PROGRAM, "distributed.cli.dask_worker", "--scheduler-file", file, "--no-dashboard"]
    order += ["--nthreads", "1", "--no-nanny", "--host", "127.0.0.1"]
    processes += [subprocess.Popen(order, cwd=tmp_path, **QUIET) for _ in range(2)]
    import json

    yield json.loads(file.read_text())["address"], processes[1:]
    for process in processes:
        process.kill()
        process.wait()


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        own = [int(text) for text in file.read().split()]
    for thread in os.listdir(f"/proc/{pid}/task"):
        with open(f"/proc/{pid}/task/{thread}/children") as file:
            own += [int(text) for text in file.read().split()]
    return own


def test_every_clip_ends_once_though_a_worker_is_killed(cluster, resumed, clips, tmp_path):
    address, workers = cluster
    for name in ("one.mp4", "two.mp4", "faceless.mp4"):
        shutil.copy(clips / name, tmp_path)
    out = tmp_path / "out"
    order = [sys.executable, "-m", "mimetic", "batch", tmp_path, "--out", out, "--submit", "dask"]
    batch = subprocess.Popen(
        [*order, "--address", address], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    one = out / "one" / "task.json"
    while not (one.exists() and '"begun": "capture"' in one.read_text()):
        assert batch.poll() is None, batch.stderr.read()
        time.sleep(0.1)
    victim = next(worker for worker in workers if children(worker.pid))
    victim.send_signal(signal.SIGKILL)
    told, errors = batch.communicate()
    assert batch.returncode == 1, errors
    assert "faceless: no frontal face" in told and "2 clips done, 1 not" in told
    for clip in ("one", "two"):
        for name in ("performance.npz", "fit.json", "overlay.mp4"):
            made = (out / clip / name).read_bytes()
            assert made == (resumed[0] / clip / name).read_bytes(), (clip, name)
        assert list((out / clip).glob(".mimetic*")) == []
        assert list((out / clip).glob("*.kept*")) == []
    assert sorted(path.name for path in out.iterdir() if path.is_dir()) == [
        "faceless",
        "one",
        "two",
    ]


def test_a_scheduler_that_is_not_there_is_one_line(mimetic, tmp_path, clips, monkeypatch):
    from mimetic import UnreadableMedia
    from mimetic.batch import on_dask

    monkeypatch.setattr(on_dask, "CONNECTING", 1.0)
    with pytest.raises(UnreadableMedia, match="no scheduler is reached"):
        on_dask.Cluster("tcp://127.0.0.1:9", 1).run(tmp_path, {"one": 1.0})
    ran = mimetic("batch", clips / "one.mp4", "--out", tmp_path / "out", "--submit", "dask")
    assert ran.returncode == 2 and "--address" in ran.stderr
