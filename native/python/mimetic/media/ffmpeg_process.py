# SPDX-License-Identifier: GPL-3.0-or-later
"""An ffmpeg at work, what it decodes and what it says."""

from __future__ import annotations

import contextlib
import io
import subprocess
import threading
from collections import deque
from collections.abc import Callable, Iterator
from typing import IO, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Running(NamedTuple):
    """An ffmpeg at work."""

    process: subprocess.Popen[bytes]
    output: io.BufferedReader  # what it decodes
    errors: deque[bytes]  # the last lines that it wrote


@contextlib.contextmanager
def running(
    command: list[str], longest: int = 50, on_line: Callable[[bytes], bool] | None = None
) -> Iterator[Running]:
    """The process and its last lines of errors; killed however the block is left.

    on_line: given each line in a thread of its own; one for which it is true is not kept.
    """
    # A session of its own: Ctrl-C is ours to handle, the child ends by the block below.
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert isinstance(process.stdout, io.BufferedReader) and process.stderr  # pipes, as requested
    errors: deque[bytes] = deque(maxlen=longest)
    reader = threading.Thread(target=_collect, args=(process.stderr, errors, on_line), daemon=True)
    reader.start()
    try:
        yield Running(process, process.stdout, errors)
    finally:
        if process.poll() is None:
            process.kill()
        process.wait()
        reader.join()
        process.stdout.close()
        process.stderr.close()


def _collect(
    stream: IO[bytes], lines: deque[bytes], on_line: Callable[[bytes], bool] | None
) -> None:
    while line := stream.readline(4096):
        if on_line is None or not on_line(line):
            lines.append(line.rstrip())


def fill(stream: io.BufferedReader, image: NDArray[np.uint8]) -> bool:
    """Reads a whole picture; false where the stream ends before."""
    view = image.data.cast("B")
    while len(view):
        count = stream.readinto(view)
        if not count:
            return False
        view = view[count:]
    return True
