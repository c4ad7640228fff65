# SPDX-License-Identifier: GPL-3.0-or-later
"""Every reader of files on some changed files of a fixed seed; `scripts/fuzz` goes on for hours."""

import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path
from random import Random

import pytest
from fuzz import judge
from fuzz.judge import BUG, REFUSED, RIGHT, read_file, run
from fuzz.readers import READERS, Reader, make_case
from fuzz.samples import Sample
from mimetic import InvalidInput

TESTS = Path(__file__).resolve().parents[2]
CASES = 250


def test_no_changed_file_ends_in_a_bug():
    """In a process of its own, which has no threads when it forks."""
    path = os.pathsep.join(map(str, (TESTS, TESTS / "python")))
    one = {"PYTHONPATH": path, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    ran = subprocess.run(
        [sys.executable, "-m", "fuzz", "--seed", "17", "--cases", str(CASES)],
        capture_output=True,
        text=True,
        env=os.environ | one,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    rows = [line.split() for line in ran.stdout.splitlines()[1:]]
    assert {row[0] for row in rows} == READERS.keys()
    for name, cases, right, refused, _bugs in rows:
        assert int(cases) >= CASES // 10 and int(right) > 0 and int(refused) > 0, name


@pytest.mark.parametrize("name", READERS)
def test_sound_files_are_right(name, tmp_path):
    for i, sample in enumerate(READERS[name].samples()):
        path = tmp_path / f"{i}{sample.suffix}"
        path.write_bytes(sample.content)
        end = read_file(name, path)
        assert end.kind == RIGHT, end.text


def test_the_same_seed_makes_the_same_files(tmp_path):
    for name, reader in READERS.items():
        result = list(reader.samples())
        contents = []
        for again in ("a", "b"):
            folder = tmp_path / f"{name}-{again}"
            folder.mkdir()
            path = make_case(reader, result, folder, Random(f"{name}/5/7"))
            contents.append(path.read_bytes() if path.exists() else path.name)
        assert contents[0] == contents[1], name


def fill_memory(_path):
    bytearray(2 * judge.MEMORY)


def refuse_at_length(_path):
    raise InvalidInput("x" * 5000)


def compute_for_long(_path):
    start = time.process_time()
    while time.process_time() - start < 60:
        pass


BUGS = {
    "IndexError": lambda _path: [][1],
    "MemoryError": fill_memory,
    "SIGSEGV": lambda _path: os.kill(os.getpid(), signal.SIGSEGV),
    "exit status 3": lambda _path: os._exit(3),
    "a line of 5000": refuse_at_length,
    "took more than": compute_for_long,
    "RuntimeWarning": lambda _path: warnings.warn("overflow", RuntimeWarning, stacklevel=1),
}


@pytest.mark.parametrize("said", BUGS)
def test_bugs_are_known_as_such_and_their_files_kept(said, tmp_path, monkeypatch):
    contents = iter([b"good", b"good", b"bad"])
    changing = Sample(".bin", b"", (lambda _content, _random: next(contents),))

    def read(path):
        if path.read_bytes() == b"bad":
            BUGS[said](path)

    monkeypatch.setitem(READERS, "test", Reader(lambda: [changing], read))
    monkeypatch.setattr(judge, "CPU_SECONDS", 2.0)
    monkeypatch.setattr(judge, "MEMORY", 1 << 28)
    ends = list(run("test", 1, 0, 3, tmp_path))
    assert [end.kind for end in ends] == [RIGHT, RIGHT, BUG]
    assert said in ends[2].text
    assert ends[2].file.read_bytes() == b"bad"


def test_refusals_are_not_bugs(tmp_path, monkeypatch):
    def refuse(path):
        raise InvalidInput(f"{path}: no")

    monkeypatch.setitem(READERS, "test", Reader(READERS["points"].samples, refuse))
    assert [end.kind for end in run("test", 1, 0, 3, tmp_path)] == [REFUSED] * 3
