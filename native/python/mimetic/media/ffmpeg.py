# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the ffmpeg program is that the imageio-ffmpeg wheel carries, and how it fails."""

from __future__ import annotations

import errno
import importlib.resources
import os
import signal
import stat
from collections.abc import Iterable
from pathlib import Path

from mimetic._core import UnreadableMedia

NO_MEMORY = (
    *(b"Cannot allocate memory", b"Resource temporarily unavailable"),
    *(b"get_buffer() failed", b"std::bad_alloc"),
)


def ffmpeg_program() -> str:
    """Path of a runnable ffmpeg; the variable IMAGEIO_FFMPEG_EXE names another one.

    Raises UnreadableMedia if there is none.
    """
    from imageio_ffmpeg import get_ffmpeg_exe

    if "IMAGEIO_FFMPEG_EXE" not in os.environ:
        make_runnable(Path(str(importlib.resources.files("imageio_ffmpeg.binaries"))))
    try:
        return get_ffmpeg_exe()
    except RuntimeError as error:
        raise UnreadableMedia(f"no video can be read: {error}") from None


def failure_of(status: int, words: Iterable[bytes], path: str | os.PathLike[str]) -> OSError | None:
    """Why ffmpeg gave up on a file that may be sound; None where its end says nothing of the kind.

    status: its exit status, or minus the signal that ended it; words: the lines that it wrote.
    """
    if status == 0:
        return None
    # A limit for the process shows as failed threads and buffers, one for many as a kill
    if status == -signal.SIGKILL or any(sign in line for line in words for sign in NO_MEMORY):
        text = "ffmpeg ran out of memory; scale the footage down, or do less at once"
        return OSError(errno.ENOMEM, text, str(path))
    if status < 0:
        text = f"ffmpeg was ended by {signal.Signals(-status).name}"
        return OSError(errno.EIO, text, str(path))
    return None


def make_runnable(folder: Path) -> None:
    """Give the programs in a folder their execute bit back: Blender unpacks wheels without it."""
    for program in folder.glob("ffmpeg-*"):
        mode = program.stat().st_mode
        if mode & stat.S_IXUSR:
            continue
        try:
            program.chmod(mode | (mode & 0o444) >> 2)
        except OSError as error:
            raise UnreadableMedia(
                f"{program} may not be run ({error.strerror}); make it executable, "
                "or name an ffmpeg in the variable IMAGEIO_FFMPEG_EXE"
            ) from None
