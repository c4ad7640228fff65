# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from mimetic.shared.folder_lock import in_use
from mimetic.shared.regular_file import check_replaceable

HIDDEN = ".mimetic-"  # how the names of files begin that are not done yet
# Ends the name of the folder with the pictures that a file refers to: the file's own name and this
TEXTURES = ".textures"


@contextlib.contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A stream to a file beside `path`, which takes its place when the block ends well.

    If it does not, `path` is as it was and nothing is left beside it. Raises OSError that names
    `path`, UnreadableMedia if that is a folder, a device or read-only.
    """
    with file_beside(path, ".part") as aside, open(aside, "wb") as stream:
        yield stream


@contextlib.contextmanager
def file_beside(path: str | os.PathLike[str], suffix: str) -> Iterator[Path]:
    """An empty file beside `path`, for others to write, which takes its place in the end.

    suffix: of its name, as writers choose the format by it. A block that removes the file, or
    raises, leaves `path` as it was. A link at `path` stays, and the file that it names is replaced.
    """
    target = Path(os.path.realpath(path))
    check_replaceable(target, str(path))
    begin = str(target.parent / HIDDEN)  # of what is made here, or could not be

    def make() -> str:
        # A name of its own: two writers of one file each end well
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=HIDDEN, suffix=suffix)
        os.close(handle)
        return name

    try:
        with in_use(make) as name:
            aside = Path(name)
            try:
                yield aside
                if aside.exists():
                    aside.chmod(0o644)
                    os.replace(aside, target)
            finally:
                with contextlib.suppress(OSError):
                    aside.unlink()
    except OSError as error:
        if error.errno is not None and str(error.filename or begin).startswith(begin):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


@contextlib.contextmanager
def file_with_textures(path: str | os.PathLike[str]) -> Iterator[Path]:
    """As `file_beside`, for a file that may refer to pictures: there is none yet, it has the name
    of `path` in a folder of its own, and a folder of its textures there takes its place with it.

    Textures of what was at `path` before go, and nothing else in that folder is kept.
    """
    target = Path(os.path.realpath(path))
    check_replaceable(target, str(path))
    begin = str(target.parent / HIDDEN)  # of what is made here
    try:
        with in_use(lambda: tempfile.mkdtemp(prefix=HIDDEN, dir=target.parent)) as folder:
            aside = Path(folder, target.name)
            try:
                yield aside
                if aside.exists():
                    aside.chmod(0o644)
                    _replace_textures(aside, target)
                    os.replace(aside, target)
            finally:
                shutil.rmtree(folder, ignore_errors=True)
    except OSError as error:
        if error.errno is not None and str(error.filename or begin).startswith(begin):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def _replace_textures(aside: Path, target: Path) -> None:
    new, old = (path.with_name(path.name + TEXTURES) for path in (aside, target))
    if os.path.lexists(old):
        os.replace(old, aside.with_name("textures before"))
    if new.is_dir():
        os.replace(new, old)
