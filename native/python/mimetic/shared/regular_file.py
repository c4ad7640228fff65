# SPDX-License-Identifier: GPL-3.0-or-later
"""Which files may be read, and which may be written: checked before the work, in one place.

Only regular files are either: a read of a pipe waits forever, a device never ends, and replacing
one takes it from all programs.
"""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia

KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def check_input(path: str | os.PathLike[str], what: str) -> None:
    """Raises UnreadableMedia unless `path` is a regular file, or a link to one, that can be read.

    what: what to give instead, such as "a video file".
    """
    try:
        if kind := _kind(os.stat(path).st_mode):
            raise UnreadableMedia(f"{path} is {kind}, not a file; give {what}")
        with open(path, "rb"):
            pass
    except UnreadableMedia:
        raise
    except (FileNotFoundError, NotADirectoryError):
        raise UnreadableMedia(f"{path}: there is no such file; give {what}") from None
    except PermissionError:
        raise UnreadableMedia(f"{path} cannot be opened: no permission to read it") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = getattr(error, "strerror", None) or error
        raise UnreadableMedia(f"{str(path)!r} cannot be opened: {reason}") from None


def check_target(
    path: str | os.PathLike[str], *inputs: str | os.PathLike[str], option: str = "--out"
) -> None:
    """Raises UnreadableMedia unless a file can be written at `path`, or replaced if it is there.

    inputs: files that the work reads; InvalidInput if `path` is one of them. A link stands for
    the file that it names.
    """
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise UnreadableMedia(f"{option} {path}: there is no folder {target.parent}")
    check_replaceable(target, f"{option} {path}")
    for source in inputs:
        if target.exists() and os.path.exists(source) and os.path.samefile(target, source):
            raise InvalidInput(f"{option} {path} would replace what is read; give another name")
    check_folder(target.parent, f"{option} {path}")


def check_replaceable(path: str | os.PathLike[str], name: str = "") -> None:
    """Raises UnreadableMedia if what is at `path` may not be replaced by a file.

    name: what to call it.
    """
    name = name or str(path)
    try:
        mode = os.stat(path).st_mode
    except FileNotFoundError:
        return
    except OSError as error:
        raise UnreadableMedia(f"{name}: {error.strerror}; give another name") from None
    if kind := _kind(mode):
        raise UnreadableMedia(f"{name} is {kind}; give the name of a file")
    # The superuser may write all the same, but who took the right away meant it
    if not mode & 0o222 or not os.access(path, os.W_OK):
        raise UnreadableMedia(f"{name} is read-only; give another name or make it writable")


def check_folder(folder: Path, name: str) -> None:
    """Raises UnreadableMedia unless files can be made in a folder; leaves none there."""
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UnreadableMedia(
            f"{name}: {error.strerror}; give a folder that can be written to"
        ) from None


def kind_of(path: str | os.PathLike[str]) -> str:
    """What is at `path`, "a folder" say; the empty string for a regular file, or nothing."""
    return _kind(os.stat(path).st_mode) if os.path.exists(path) else ""


def _kind(mode: int) -> str:
    if stat.S_ISREG(mode):
        return ""
    return next((name for is_kind, name in KINDS if is_kind(mode)), "no regular file")
