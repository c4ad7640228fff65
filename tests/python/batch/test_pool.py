# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop over processes, with stand-ins for the clips."""

import gc
import os
import signal
import subprocess
import sys
import time

from mimetic.batch.pool import Pool


def script(code, *arguments):
    return [sys.executable, "-c", code, *map(str, arguments)]


def run(pool, commands):
    return pool.run(commands, dict.fromkeys(commands, 1.0))


COUNTED = """
import sys, pathlib
path = pathlib.Path(sys.argv[1]); path.write_text(path.read_text() + 'x' if path.exists() else 'x')
"""


def test_one_failure_does_not_stop_the_others():
    good, bad = script("pass"), script("import sys; sys.exit('mimetic: no face found')")
    commands = {f"clip {i}": bad if i == 3 else good for i in range(8)}
    outcomes = run(Pool(3, 0), commands)
    assert {name for name, outcome in outcomes.items() if outcome.status} == {"clip 3"}
    assert outcomes["clip 3"].message == "no face found" and len(outcomes) == 8


def test_a_failed_task_is_tried_again_and_bad_input_is_not(tmp_path):
    passing = COUNTED + "if path.read_text() == 'x': sys.exit('mimetic: disk full')"
    commands = {
        "passing": script(passing, tmp_path / "passing"),
        "failing": script(COUNTED + "sys.exit(1)", tmp_path / "failing"),
        "bad": script(COUNTED + "sys.exit(2)", tmp_path / "bad"),
    }
    outcomes = run(Pool(2, 2), commands)
    tries = {name: len((tmp_path / name).read_text()) for name in commands}
    assert tries == {"passing": 2, "failing": 3, "bad": 1}
    assert {name: outcome.status for name, outcome in outcomes.items()} == {
        "passing": 0,
        "failing": 1,
        "bad": 2,
    }
    assert outcomes["passing"].num_tries == 2


def test_costly_tasks_are_begun_first(tmp_path):
    begun = tmp_path / "begun"
    code = "import sys, pathlib; print(sys.argv[1], file=pathlib.Path(sys.argv[2]).open('a'))"
    weights = {"short": 1.0, "long": 5.0, "middle": 2.0}
    Pool(1, 0).run({name: script(code, name, begun) for name in weights}, weights)
    assert begun.read_text().split() == ["long", "middle", "short"]


def test_so_many_run_at_a_time(tmp_path):
    code = """
import os, sys, time, pathlib
folder = pathlib.Path(sys.argv[1]); mine = folder / str(os.getpid()); mine.touch()
time.sleep(.3); print('mimetic: at once', len(list(folder.iterdir())), file=sys.stderr)
time.sleep(.3); mine.unlink(); sys.exit(2)
"""
    outcomes = run(Pool(3, 0), {str(i): script(code, tmp_path) for i in range(6)})
    assert max(int(one.message.split()[-1]) for one in outcomes.values()) == 3


def test_a_process_that_is_killed_is_told_by_its_signal():
    code = "import os; os.kill(os.getpid(), 9)"
    outcomes = run(Pool(1, 1), {"clip": script(code)})
    assert outcomes["clip"].num_tries == 2 and "SIGKILL" in outcomes["clip"].message


def test_what_no_process_can_be_started_for_is_a_failure():
    outcomes = run(Pool(1, 0), {"clip": ["/no/such/program"]})
    assert outcomes["clip"].status == 1 and "No such file" in outcomes["clip"].message


def test_progress_follows_what_the_processes_report():
    code = (
        "import sys, time; print(' 40 %  following', file=sys.stderr, flush=True); time.sleep(.5)"
    )
    seen = []
    pool = Pool(1, 0)
    commands = {"one": script(code), "two": script("pass")}
    pool.run(commands, {"one": 3.0, "two": 1.0}, lambda fraction, number: seen.append(fraction))
    assert any(abs(fraction - 0.3) < 1e-9 for fraction in seen) and seen == sorted(seen)


def test_when_stopped_none_is_begun_and_those_at_work_may_finish_their_part(tmp_path):
    code = """
import signal, sys, time, pathlib
def end(*_): pathlib.Path(sys.argv[1]).write_text('kept'); sys.exit(143)
signal.signal(signal.SIGTERM, end); pathlib.Path(sys.argv[2]).touch(); time.sleep(60)
"""
    started, kept = tmp_path / "started", tmp_path / "kept"
    pool = Pool(1, 5, is_stopped=started.exists)
    outcomes = run(pool, {"one": script(code, kept, started), "two": script("pass")})
    assert kept.read_text() == "kept" and list(outcomes) == ["one"]
    assert outcomes["one"].status == 143 and outcomes["one"].num_tries == 1


def test_processes_end_when_the_batch_is_killed(tmp_path):
    child = (
        "import os, sys; print(os.getpid(), file=open(sys.argv[1], 'w'), flush=True); os.read(0, 1)"
    )
    code = f"""
import sys; from mimetic.batch.pool import Pool
Pool(1, 0).run({{'clip': [sys.executable, '-c', {child!r}, sys.argv[1]]}}, {{'clip': 1}})
"""
    path = tmp_path / "pid"
    parent = subprocess.Popen(script(code, path))
    while not (path.exists() and path.read_text().strip()):
        time.sleep(0.05)
    pid = int(path.read_text())
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    for _ in range(200):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return
        with open(f"/proc/{pid}/stat") as stat:
            if stat.read().split()[2] == "Z":
                return
        time.sleep(0.05)
    raise AssertionError("it works on")


def test_four_hundred_tasks_leave_nothing_open_and_need_no_more_memory():
    """What each task would leave behind shows as growth between the first and the last of them."""
    states = []

    def note(_name, _outcome):
        with open("/proc/self/statm") as file:
            pages = int(file.read().split()[1])
        states.append((len(os.listdir("/proc/self/fd")), pages * os.sysconf("SC_PAGE_SIZE") / 1e6))

    outcomes = run(Pool(4, 0, ended=note), {str(i): ["/bin/true"] for i in range(400)})
    assert len(outcomes) == 400 and not any(outcome.status for outcome in outcomes.values())
    (first_files, first_mb), (last_files, last_mb) = states[100], states[-1]
    assert last_files <= first_files + 8 and last_mb < first_mb + 3


PARALLEL = """
import numpy as np
from pathlib import Path
from mimetic._core import FlowMethod, FlowOptions, compute_flow
options = FlowOptions()
options.method = FlowMethod.dis
image = np.random.default_rng(1).integers(0, 255, (240, 320), dtype=np.uint8)
compute_flow(image, np.roll(image, 1, axis=1), options)
lines = Path('/proc/self/status').read_text().splitlines()
raise SystemExit(next(line for line in lines if line.startswith('Threads:')))
"""


def test_a_process_of_the_batch_starts_no_threads():
    outcome = run(Pool(1, 0), {"clip": script(PARALLEL)})["clip"]
    assert outcome.message.split() == ["Threads:", "1"]


def test_processes_that_have_ended_are_not_kept():
    pool, before = Pool(2, 0), alive_processes()
    run(pool, {str(i): script("pass") for i in range(6)})
    assert alive_processes() == before


def alive_processes() -> int:
    gc.collect()
    return sum(isinstance(one, subprocess.Popen) for one in gc.get_objects())
