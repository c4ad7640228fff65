# SPDX-License-Identifier: GPL-3.0-or-later
"""Processes of this machine that do tasks, so many at a time."""

from __future__ import annotations

import contextlib
import os
import queue
import re
import signal
import subprocess
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import IO

BAD_INPUT = 2  # an exit status: trying again would not help
TICK_SECONDS = 0.1
LONGEST_LINE = 1 << 16  # bytes
PROGRESS = re.compile(r" *(\d{1,3}) % ")  # as commands report it where there is no terminal
FAILURE = re.compile(r"mimetic(?: \w+)?: (?:error: )?(.*)")
# Numerical libraries start threads by themselves: processes share the cores already, and one alone
# is faster without them, as its matrices are small
ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OPENCV_FOR_THREADS_NUM"), "1"
)

Command = Sequence[str]
# (share of the work that is done, tasks that ended) -> None
Show = Callable[[float, int], None]


@dataclass
class Outcome:
    """How a task ended."""

    status: int
    message: str = ""
    num_tries: int = 0
    seconds: float = 0.0


@dataclass
class _Job:
    name: str
    command: Command
    weight: float
    fraction: float = 0.0
    process: subprocess.Popen | None = None


@dataclass
class Pool:
    """Runs commands in `num_processes` processes; a failed one once more, `num_retries` times.

    A command gets a pipe as standard input, which closes when this process ends in any way.
    """

    num_processes: int
    num_retries: int
    is_stopped: Callable[[], bool] = lambda: False
    ended: Callable[[str, Outcome], None] = lambda _name, _outcome: None  # as each task ends
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    _jobs: list[_Job] = field(default_factory=list)

    def run(
        self,
        commands: Mapping[str, Command],
        weights: Mapping[str, float],
        show: Show = lambda _fraction, _num_ended: None,
    ) -> dict[str, Outcome]:
        """Outcome by name, of those that were begun; weights: of what the tasks cost.

        The costly ones are begun first: none of them is left to the end for one process alone.
        When `is_stopped` says so those at work are ended by SIGTERM, and no other is begun.
        """
        self._jobs = [_Job(name, command, weights[name]) for name, command in commands.items()]
        waiting: queue.SimpleQueue[_Job] = queue.SimpleQueue()
        for job in sorted(self._jobs, key=lambda job: -job.weight):
            waiting.put(job)
        stopping = threading.Event()
        posts: queue.SimpleQueue[tuple[str, Outcome]] = queue.SimpleQueue()
        workers = [
            threading.Thread(target=self._work, args=(waiting, posts, stopping), daemon=True)
            for _ in range(min(self.num_processes, len(self._jobs)))
        ]
        for worker in workers:
            worker.start()
        try:
            while any(worker.is_alive() for worker in workers):
                time.sleep(TICK_SECONDS)
                self._collect(posts)
                show(self._fraction(), len(self.outcomes))
                if self.is_stopped() and not stopping.is_set():
                    stopping.set()
                    self._send(signal.SIGTERM)
        finally:
            stopping.set()
            self._send(signal.SIGKILL)  # of an end at once: otherwise none is left
            for worker in workers:
                worker.join()
            self._collect(posts)
        return self.outcomes

    def _collect(self, posts: queue.SimpleQueue[tuple[str, Outcome]]) -> None:
        with contextlib.suppress(queue.Empty):
            while True:
                name, outcome = posts.get_nowait()
                self.outcomes[name] = outcome
                self.ended(name, outcome)

    def _fraction(self) -> float:
        whole = sum(job.weight for job in self._jobs) or 1.0
        return sum(job.weight * job.fraction for job in self._jobs) / whole

    def _send(self, number: signal.Signals) -> None:
        for job in self._jobs:
            process = job.process
            if process is not None and process.poll() is None:
                process.send_signal(number)

    def _work(
        self,
        waiting: queue.SimpleQueue[_Job],
        posts: queue.SimpleQueue[tuple[str, Outcome]],
        stopping: threading.Event,
    ) -> None:
        while not stopping.is_set():
            try:
                job = waiting.get_nowait()
            except queue.Empty:
                return
            start = time.monotonic()
            for number in range(1 + self.num_retries):
                outcome = self._try(job, stopping)
                outcome.num_tries = number + 1
                outcome.seconds = time.monotonic() - start
                if outcome.status in (0, BAD_INPUT) or stopping.is_set():
                    break
            job.fraction = 1.0
            posts.put((job.name, outcome))

    def _try(self, job: _Job, stopping: threading.Event) -> Outcome:
        try:
            process = subprocess.Popen(
                job.command,
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                env={**ONE_THREAD, **os.environ},
                start_new_session=True,  # Ctrl-C is ours to handle
            )
        except OSError as error:
            return Outcome(1, f"no process could be started: {error.strerror}")
        job.process = process
        if stopping.is_set():  # since the signal was sent to the others
            process.terminate()
        assert process.stderr is not None and process.stdin is not None
        lines = _read(process.stderr, job)
        status = process.wait()
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
        process.stderr.close()
        job.process = None  # of an ended one nothing is asked any more
        return outcome_of(status, lines)


def num_cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _read(stream: IO[bytes], job: _Job) -> list[str]:
    """The last lines of a process; the job's fraction follows what it reports."""
    last: deque[str] = deque(maxlen=20)
    while line := stream.readline(LONGEST_LINE):
        text = line.decode(errors="replace").rstrip()
        if match := PROGRESS.match(text):
            job.fraction = max(job.fraction, min(int(match[1]), 99) / 100)
        elif text:
            last.append(text)
    return list(last)


def outcome_of(status: int, lines: Sequence[str]) -> Outcome:
    """How a process ended that wrote these lines last."""
    return Outcome(status, "" if status == 0 else _message(status, lines))


def _message(status: int, lines: Sequence[str]) -> str:
    for line in reversed(lines):
        if match := FAILURE.fullmatch(line):
            return match[1]
    if status < 0:
        name = signal.Signals(-status).name if -status in set(signal.Signals) else str(-status)
        return f"its process was ended by {name}" + (
            ": not enough memory, or somebody ended it" if -status == signal.SIGKILL else ""
        )
    return lines[-1] if lines else f"its process ended with status {status}"
