# SPDX-License-Identifier: GPL-3.0-or-later
"""Work done in a process of its own, which gives its memory back."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import ParamSpec, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def process_pool(num_processes: int) -> ProcessPoolExecutor:
    """Processes that are spawned, not forked: OpenCV's threads do not survive a fork."""
    return ProcessPoolExecutor(num_processes, mp_context=multiprocessing.get_context("spawn"))


def in_own_process(
    task: Callable[Arguments, Result], *arguments: Arguments.args, **named: Arguments.kwargs
) -> Result:
    """What `task` returns, or raises; task, arguments and result are pickled on the way."""
    with process_pool(1) as pool:
        return pool.submit(task, *arguments, **named).result()
