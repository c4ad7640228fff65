# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the ffmpeg program is that the imageio-ffmpeg wheel carries."""

from __future__ import annotations

import importlib.resources
import os
import stat
from pathlib import Path

from mimetic._core import UnreadableMedia


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
