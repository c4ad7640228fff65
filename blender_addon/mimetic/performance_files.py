# SPDX-License-Identifier: GPL-3.0-or-later
"""Performance files that were read, and what is remembered of their content."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass

import numpy as np

from . import native

MEASURED = (
    "frame",
    "activations",
    "activations_std",
    "articulator_values",
    "articulator_values_std",
    "confounded_with",
    "quality",
)


@dataclass(frozen=True)
class Content:
    """What is remembered of a file that was read."""

    footage: str  # fingerprint of its footage, "" if it is not known
    capture: str  # `capture_of`


_seen: dict[str, tuple] = {}  # file: its state when read, and its content, None if it has none


def _state(path: str) -> tuple[int, int] | None:
    try:
        facts = os.stat(path)
    except OSError:  # reading it says why
        return None
    return facts.st_mtime_ns, facts.st_size


def read(path: str):
    """The file's Performance; raises what it raises."""
    state = _state(path)
    performance = native.performances().Performance.load(path)
    footage = performance.footage[1] if performance.footage else ""
    _seen[path] = state, Content(footage, capture_of(performance))
    return performance


def content_of(path: str) -> Content | None:
    """Of a file that may have been read before; None of one that cannot be."""
    state = _state(path)
    if path not in _seen or _seen[path][0] != state:  # panels ask at every drawing
        try:
            read(path)
        except native.known_errors():
            _seen[path] = state, None
    return _seen[path][1]


def is_of(path: str, fingerprint: str) -> bool:
    """Whether a file is a take of the footage with a fingerprint, as far as either is known."""
    if not fingerprint:
        return True
    content = content_of(path)
    return content is not None and content.footage in ("", fingerprint)


def capture_of(performance) -> str:
    """Digest of what a `mimetic.performance.Performance` has measured: the values of each frame,
    how far these may be off, and where the face was lost."""
    digest = hashlib.sha256()
    for name in MEASURED:
        values = getattr(performance, name)
        digest.update(name.encode())
        if values is not None:
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def holds(path: str, row) -> bool:
    """Whether a file has what a `captured_rows.NamesCapture` was noted with, as far as that is
    known."""
    if not row.capture:
        return True
    content = content_of(path)
    return content is not None and content.capture == row.capture


def was_read(path: str) -> bool:
    return path in _seen
