# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether what is read is still what was opened: shares are unmounted, files moved or replaced."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from pathlib import Path

from mimetic.media.image_sequence import ImageSequence


class SourceState:
    """Which files a path named when this was made: the file, or every picture of a sequence."""

    def __init__(self, path: ImageSequence | Path) -> None:
        self._path = path
        self._marks = [_mark_of(one) for one in _files_of(path)]

    def failure(self) -> OSError | None:
        """Why the path cannot be read to its end any more; None where it is as it was."""
        for one, mark in zip(_files_of(self._path), self._marks, strict=True):
            try:
                now = _mark_of(one)
                with open(one, "rb") as stream:
                    stream.read(1)
            except OSError as error:
                reason = error.strerror or "it cannot be opened"
                text = f"it went away while it was read ({reason}): bring it back, and try again"
                return OSError(error.errno or errno.EIO, text, str(one))
            if now != mark:
                text = "it was replaced or written to while it was read: try again"
                return OSError(errno.EIO, text, str(one))
        return None


def _files_of(path: ImageSequence | Path) -> Iterator[Path]:
    if isinstance(path, ImageSequence):
        return (path.frame_path(frame) for frame in range(1, 1 + path.num_frames))
    return iter([path])


def _mark_of(path: Path) -> int:
    """Differs, in all likelihood, for another file and for other content; a number, to be small."""
    status = os.stat(path)
    return hash((status.st_ino, status.st_size, status.st_mtime_ns))
