# SPDX-License-Identifier: GPL-3.0-or-later
"""Ctrl-C, SIGTERM and a terminal that closes end a command well, at any time."""

import os
import signal
import subprocess
import sys
import time

import pytest
from mimetic.shared.interrupts import Ended, listen_for_interrupt, signals_raised

pytestmark = pytest.mark.usefixtures("hangup_heard")
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


@pytest.mark.parametrize("number", STATUS)
def test_the_first_signal_asks_and_the_second_ends(number, capfd):
    before = signal.getsignal(number)
    with pytest.raises(Ended) as request, listen_for_interrupt("half is kept") as interrupted:
        assert not interrupted() and interrupted.status == 0
        os.kill(os.getpid(), number)
        assert interrupted() and interrupted.status == STATUS[number]
        assert "stopping: half is kept" in capfd.readouterr().err
        os.kill(os.getpid(), signal.SIGTERM if number == signal.SIGHUP else number)
    assert request.value.status == (143 if number == signal.SIGHUP else STATUS[number])
    assert signal.getsignal(number) is before


def test_a_shell_that_tells_of_a_closed_terminal_once_more_ends_nothing(capfd):
    with listen_for_interrupt() as interrupted:
        for _ in range(2):
            os.kill(os.getpid(), signal.SIGHUP)
        assert interrupted.status == 129
    assert capfd.readouterr().err.count("(SIGTERM ends at once)") == 1
    cleaned = []
    with pytest.raises(Ended) as request, signals_raised():
        try:
            os.kill(os.getpid(), signal.SIGHUP)
        finally:
            os.kill(os.getpid(), signal.SIGHUP)
            cleaned.append(True)
    assert cleaned and request.value.status == 129


@pytest.mark.parametrize("number", STATUS)
def test_a_signal_that_was_ignored_from_the_start_stays_so(number):
    """Ctrl-C, for a job that a script runs in the background; SIGHUP, by nohup."""
    before = signal.signal(number, signal.SIG_IGN)
    try:
        with signals_raised(), listen_for_interrupt() as interrupted:
            os.kill(os.getpid(), number)
            assert not interrupted() and signal.getsignal(number) is signal.SIG_IGN
        assert signal.getsignal(number) is signal.SIG_IGN
    finally:
        signal.signal(number, before)


def test_work_that_gives_up_when_asked_ends_by_the_signal_that_asked():
    with pytest.raises(Ended) as request, listen_for_interrupt():
        os.kill(os.getpid(), signal.SIGTERM)
        raise KeyboardInterrupt
    assert request.value.status == 143


def test_a_signal_unwinds_what_is_at_work():
    cleaned = []
    with pytest.raises(Ended) as request, signals_raised():
        try:
            os.kill(os.getpid(), signal.SIGTERM)
        finally:
            cleaned.append(True)
    assert cleaned and request.value.status == 143


# Whoever reads this module's import of numpy has the process in the middle of its start
SLOW_START = """
import sys, time
class Slow:
    def find_spec(self, name, path=None, target=None):
        if name == "mimetic._core":
            print("loading", flush=True)
            time.sleep(60)
sys.meta_path.insert(0, Slow())
import runpy
sys.argv = ["mimetic", "info", "p.npz"]
runpy.run_module("mimetic", run_name="__main__")
"""


@pytest.mark.parametrize("number", STATUS)
def test_a_signal_while_the_command_loads_gives_no_traceback(number):
    process = subprocess.Popen(
        [sys.executable, "-c", SLOW_START],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "loading\n"
    process.send_signal(number)
    _, errors = process.communicate(timeout=30)
    assert (process.returncode, errors) == (STATUS[number], "mimetic: stopped\n")


@pytest.mark.parametrize("number", STATUS)
def test_a_signal_held_back_while_python_starts_is_heard_then(number):
    process = subprocess.Popen(
        [sys.executable, "-m", "mimetic", "info", "absent.npz"],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: (
            signal.pthread_sigmask(signal.SIG_BLOCK, [number]),
            os.kill(os.getpid(), number),
        ),
    )
    _, errors = process.communicate(timeout=30)
    assert (process.returncode, errors) == (STATUS[number], "mimetic: stopped\n")


def test_the_package_itself_loads_nothing_that_takes_time():
    code = "import sys, mimetic.shared.interrupts; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


WAITING = """
import os, subprocess, sys, time
stop = time.monotonic() + 60
import json
request = json.loads(sys.stdin.readline())
open(request["out"], "wb").write(b"half")
folder = os.path.dirname(request["out"])
stem = os.path.basename(request["out"]).rpartition(".")[0]
os.mkdir(os.path.join(folder, f".{stem}.blend.x"))
open(sys.argv[1], "w").write(str(os.getpid()))
time.sleep(60)
open(request["out"], "wb").write(b"whole")
json.dump({"text": "done"}, open(request["answer"], "w"))
"""


@pytest.mark.parametrize("number", STATUS)
def test_a_bake_that_is_ended_ends_its_blender_and_replaces_nothing(tmp_path, number):
    (tmp_path / "p.npz").write_bytes(b"x")
    (tmp_path / "face.blend").write_bytes(b"finished before")
    (tmp_path / "wait.py").write_text(WAITING)
    blender = tmp_path / "blender"
    blender.write_text(f"#!/bin/sh\nexec {sys.executable} {tmp_path}/wait.py {tmp_path}/pid\n")
    blender.chmod(0o755)
    words = ["bake", "p.npz", "--out", "face.blend", "--blender-python", str(blender)]
    before = sorted(path.name for path in tmp_path.iterdir())
    process = subprocess.Popen(
        [sys.executable, "-m", "mimetic", *words], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    child = _number_in(tmp_path / "pid")
    process.send_signal(number)
    _, errors = process.communicate(timeout=30)
    assert (process.returncode, errors) == (STATUS[number], "mimetic: stopped\n")
    assert not _runs(child)
    (tmp_path / "pid").unlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == before
    assert (tmp_path / "face.blend").read_bytes() == b"finished before"


WITH_PARENT = """
import os, sys, time
sys.path.insert(0, sys.argv[1])
import headless_bake
folder = sys.argv[2]
out = os.path.join(folder, ".mimetic-x.blend")
open(out, "w").close()
os.mkdir(os.path.join(folder, "..mimetic-x.blend.y"))
os.mkdir(os.path.join(folder, "answers"))
os.mkdir(os.path.join(folder, "its"))
answer = os.path.join(folder, "answers", "a.json")
request = {"out": out, "its_folder": os.path.join(folder, "its"), "answer": answer}
headless_bake.end_with_parent(request)
print("ready", flush=True)
time.sleep(60)
"""


def test_blender_ends_with_a_parent_that_is_killed(tmp_path, request):
    addon = request.config.rootpath / "blender_addon"
    child = subprocess.Popen(
        [sys.executable, "-c", WITH_PARENT, str(addon), str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert child.stdout.readline() == "ready\n"
    assert child.poll() is None
    child.stdin.close()  # as the system does when the parent is gone
    assert child.wait(timeout=30) == 1
    assert list(tmp_path.iterdir()) == []


def _number_in(path):
    while not (path.exists() and path.read_text()):
        time.sleep(0.02)
    return int(path.read_text())


def _runs(number):
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    return True
