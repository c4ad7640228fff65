# SPDX-License-Identifier: GPL-3.0-or-later
"""Waiting for other processes, where the system has locks."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
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
