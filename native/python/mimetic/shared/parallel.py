# SPDX-License-Identifier: GPL-3.0-or-later
"""Pieces of work at the same time, each of which spends its time in the core.

One after the other where OPENCV_FOR_THREADS_NUM allows a single thread, as a batch of processes on
one machine says. Results do not depend on it.
"""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from itertools import islice
from typing import TypeVar

A = TypeVar("A")
B = TypeVar("B")

THREADS = 2  # what is computed inside of each has threads of its own


def both(first: Callable[[], A], second: Callable[[], B]) -> tuple[A, B]:
    """What two functions return. The first works in the caller's thread; both end in any case."""
    if _is_alone():
        return first(), second()
    with ThreadPoolExecutor(1) as pool:
        other = pool.submit(second)
        try:
            return first(), other.result()
        finally:
            del other  # as below


def in_turn(work: Callable[[A], B], items: Iterable[A]) -> Generator[tuple[A, B], None, None]:
    """Each item with what `work` makes of it, in their order; at most two are held at a time."""
    if _is_alone():
        for item in items:
            yield item, work(item)
        return
    with ThreadPoolExecutor(THREADS) as pool:
        begun: deque[tuple[A, Future[B]]] = deque()
        try:
            for item in items:
                begun.append((item, pool.submit(work, item)))
                if len(begun) == THREADS:
                    yield _ended(begun)
            while begun:
                yield _ended(begun)
        finally:
            # A future holds its error, whose traceback holds this frame: in a circle they would
            # keep all that the work uses, a film that is being decoded too, until Python ends.
            begun.clear()


def side_by_side(sources: Sequence[Generator[A, None, None]]) -> Generator[A, None, None]:
    """One of each in turn, made at the same time, until the longest ends; all are closed then.

    Each is gone on with by one thread at a time, but not always the same one.
    """
    try:
        left = list(sources)
        with ThreadPoolExecutor(THREADS) as pool:
            at_once = map if _is_alone() else pool.map
            while left:
                made = list(at_once(_next_of, left))
                left = [one for one, item in zip(left, made, strict=True) if item]
                for item in made:
                    yield from item
    finally:
        for one in sources:
            one.close()


def _ended(begun: deque[tuple[A, Future[B]]]) -> tuple[A, B]:
    """The first that was begun, taken out, with what came of it."""
    item, future = begun.popleft()
    try:
        return item, future.result()
    finally:
        del future


def _next_of(items: Iterator[A]) -> tuple[A, ...]:
    """The next alone, nothing after the last."""
    return tuple(islice(items, 1))


def _is_alone() -> bool:
    return os.environ.get("OPENCV_FOR_THREADS_NUM") == "1"
