# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases in a process of their own, with limits on memory and time, and how each ended."""

from __future__ import annotations

import faulthandler
import os
import resource
import select
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from random import Random

from mimetic import InvalidInput, UnreadableMedia

from fuzz.readers import READERS, make_case

RIGHT, REFUSED, BUG = "right", "refused", "bug"
MEMORY = 3 << 30  # bytes beyond what a process has before the first case
CPU_SECONDS, WAIT_SECONDS = 20.0, 300.0  # of one case; the second for one that waits in vain
BATCH = 200  # cases in one process
LONGEST_LINE = 1000  # characters of a refusal, without the file's name


@dataclass(frozen=True)
class End:
    """How a case ended. text: of a bug, what went wrong; file: of a bug, the input, kept."""

    reader: str
    seed: int
    index: int
    kind: str
    text: str = ""
    file: Path | None = None


def run(reader: str, seed: int, first: int, last: int, kept: Path) -> Iterator[End]:
    """Cases `first` to `last` of a reader, the last not included; the same for the same seed.

    kept: folder for the inputs that end in bugs.
    """
    result = list(READERS[reader].samples())
    index = first
    while index < last:
        with tempfile.TemporaryDirectory(prefix="mimetic-fuzz-") as folder:
            until = min(last, index + BATCH)
            for end in _batch(reader, result, seed, range(index, until), Path(folder)):
                index += 1
                yield end if end.kind != BUG else _kept(end, Path(folder, str(end.index)), kept)


def read_file(reader: str, path: Path) -> End:
    """One file, read here without limits: to see where a bug is."""
    return End(reader, 0, 0, *_ended(lambda: READERS[reader].read(path), path))


def _batch(reader: str, samples: list, seed: int, cases: range, folder: Path) -> Iterator[End]:
    """Ends of the cases until one takes the process with it."""
    source, target = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(source)
        _work(reader, samples, seed, cases, folder, target)
    os.close(target)
    with os.fdopen(source, "rb", buffering=0) as stream:
        index, text = cases.start, b""
        while True:
            waited = not select.select([stream], [], [], WAIT_SECONDS)[0]
            content = b"" if waited else stream.read(65536)
            if not content:
                break
            *lines, text = (text + content).split(b"\0")
            for line in lines:
                kind, _, message = line.decode(errors="replace").partition(":")
                yield End(reader, seed, index, kind, message)
                index += 1
    if waited:
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if index < cases.stop:
        code = os.waitstatus_to_exitcode(status)
        why = f"ended by {signal.Signals(-code).name}" if code < 0 else f"exit status {code}"
        if code == -signal.SIGPROF:
            why = f"took more than {CPU_SECONDS:g} s of the processor"
        yield End(reader, seed, index, BUG, f"waited {WAIT_SECONDS:g} s" if waited else why)


def _work(reader: str, samples: list, seed: int, cases: range, folder: Path, target: int) -> None:
    """In the child, which it ends."""
    status = 1
    try:
        signal.signal(signal.SIGPROF, signal.SIG_DFL)
        faulthandler.disable()  # pytest's writes to a stream of its own
        _limit_memory()
        silence = os.open(os.devnull, os.O_WRONLY)  # what C++ or ffmpeg might print
        os.dup2(silence, 2)
        for index in cases:
            own = folder / str(index)
            own.mkdir()
            try:
                path = make_case(READERS[reader], samples, own, Random(f"{reader}/{seed}/{index}"))
            except Exception as error:  # a fault of the changes, not of a reader
                os.write(target, f"{BUG}:could not be made: {error!r}\0".encode())
                continue
            with _timer():
                kind, text = _ended(lambda path=path: READERS[reader].read(path), path)
            if kind != BUG:
                shutil.rmtree(own)
            os.write(
                target, f"{kind}:{text}".encode(errors="replace").replace(b"\0", b"\\0") + b"\0"
            )
        status = 0
    finally:
        os._exit(status)


def _limit_memory() -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 30, 1 << 30))


@contextmanager
def _timer() -> Iterator[None]:
    """The process ends by SIGPROF if the block takes too long."""
    signal.setitimer(signal.ITIMER_PROF, CPU_SECONDS)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _ended(read, path: Path) -> tuple[str, str]:
    """Kind of the end, and what is wrong. A warning of Python's on the terminal is a bug, too."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            read()
    except (InvalidInput, UnreadableMedia) as error:
        text = str(error)
        if not text or len(text.replace(str(path), "")) > LONGEST_LINE:
            return BUG, f"refused in a line of {len(text)} characters: {text[:200]!r}"
        return REFUSED, ""
    except BaseException as error:
        frames = traceback.extract_tb(sys.exc_info()[2])[-3:]
        places = " < ".join(f"{Path(f.filename).name}:{f.lineno}" for f in reversed(frames))
        return BUG, f"{type(error).__name__}: {str(error)[:200]} at {places}"
    return RIGHT, ""


def _kept(end: End, folder: Path, kept: Path) -> End:
    """The end with its input, in a folder of its own, copied to where it stays."""
    kept.mkdir(parents=True, exist_ok=True)
    inputs = [path for path in sorted(folder.iterdir()) if not path.name.endswith(".again")]
    if not inputs:
        return end
    suffix = "".join(inputs[0].suffixes)[-20:] if inputs[0].name.startswith("case") else ".mp4"
    file = kept / f"{end.reader}-{end.seed}-{end.index}{suffix}"
    shutil.copyfile(inputs[0], file)
    return End(end.reader, end.seed, end.index, end.kind, end.text, file)
