# SPDX-License-Identifier: GPL-3.0-or-later
"""Waiting for other processes, and telling which are dead, where the system has locks."""

from __future__ import annotations

import contextlib
import os
import shutil
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path


@contextlib.contextmanager
def alone_with(path: Path) -> Iterator[None]:
    """Holds the lock of an existing file or folder in the block; waits until others let it go.

    A process that ends in any way lets go. Raises OSError where `path` cannot be opened.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        yield
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        with contextlib.suppress(OSError):  # some network file systems lock nothing
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


@contextlib.contextmanager
def in_use(make: Callable[[], str]) -> Iterator[str]:
    """The path of what `make` makes; `remove_left_over` leaves it in the block.

    A process that ends in any way uses it no more. Raises what `make` raises.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        yield make()
        return
    while True:
        path, handle = make(), None
        try:
            with contextlib.suppress(OSError):  # some network file systems lock nothing
                handle = os.open(path, os.O_RDONLY)
                fcntl.flock(handle, fcntl.LOCK_EX)
            if os.path.lexists(path):  # or it was taken for left over before it was locked
                yield path
                return
        finally:
            if handle is not None:
                os.close(handle)


def remove_left_over(paths: Iterable[Path]) -> None:
    """Removes the files and folders that no process has `in_use`; all stay where nothing tells."""
    try:
        import fcntl
    except ImportError:  # Windows
        return
    for path in paths:
        with contextlib.suppress(OSError):  # it is in use, gone, or not ours
            handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if path.is_dir():
                    shutil.rmtree(path, ignore_errors=True)
                else:
                    path.unlink()
            finally:
                os.close(handle)
