# SPDX-License-Identifier: GPL-3.0-or-later
"""The open file written as a .blend, whole or not at all."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import bpy


def save_copy(path: Path, with_paths_anew: bool) -> None:
    """with_paths_anew: relative paths that hold for the open file are made to hold for the copy.

    Raises OSError where it cannot be written whole; what was there stays then.
    """
    # Beside `path`, so that relative paths hold once it has its name
    aside = path.with_name(f".{path.stem}.{os.getpid()}.blend")
    try:
        bpy.ops.wm.save_as_mainfile(
            filepath=str(aside), check_existing=False, relative_remap=with_paths_anew, copy=True
        )
        if not _is_whole(aside):  # Blender calls some files saved that a full disk cut off
            reason = "Blender wrote a part of it alone; is the disk full?"
            raise OSError(errno.ENOSPC, reason, str(path))
        os.replace(aside, path)
    finally:
        aside.unlink(missing_ok=True)


def _is_whole(path: Path) -> bool:
    """Whether Blender can read what a .blend holds, which it lists at its end."""
    try:
        with bpy.data.libraries.load(str(path)):
            return True
    except OSError:
        return False
