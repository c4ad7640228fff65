# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of one run appear together, in one moment, or not at all."""

from __future__ import annotations

import contextlib
import itertools
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.shared.folder_lock import alone_with, in_use, remove_left_over
from mimetic.shared.regular_file import check_folder, check_replaceable, kind_of
from mimetic.shared.whole_file import HIDDEN

PERFORMANCE = "performance.npz"
# What the commands that follow a clip write: with a new performance the old one's pictures go
OF_A_CLIP = (
    *(PERFORMANCE, "fit.json", "overlay.mp4", "report.html", "motion.png", "puppet.mp4"),
    *(f"{name}.{kind}" for name in ("templates", "mapping", "live") for kind in ("png", "svg")),
)
UNFINISHED = "unfinished"


def prepare_folder(out: Path, names: Iterable[str], *inputs: str | os.PathLike[str]) -> None:
    """Makes sure, before hours of work, that files of these names can be written in `out`.

    inputs: files that the work reads and that may not be replaced. Raises UnreadableMedia,
    InvalidInput.
    """
    try:
        out.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        kind = kind_of(out) or "a file"
        raise InvalidInput(f"--out {out} is {kind}; give a folder") from None
    except OSError as error:
        raise UnreadableMedia(
            f"--out {out}: {error.strerror}; give a folder that can be written to"
        ) from None
    check_folder(out, f"--out {out}")
    for name in names:
        check_replaceable(out / name, f"--out {out}: {name}")
        for source in inputs:
            if (out / name).exists() and os.path.samefile(out / name, source):
                raise InvalidInput(f"--out {out}: {name} is what is read; give another folder")


@contextlib.contextmanager
def staging(out: Path) -> Iterator[Path]:
    """A hidden folder in `out` for one run's files until they are published; then it is gone.

    Such folders of processes that were killed go first.
    """
    remove_left_over(path for path in out.glob(f"{HIDDEN}*") if path.is_dir())
    with in_use(lambda: tempfile.mkdtemp(dir=out, prefix=HIDDEN)) as name:
        folder = Path(name)
        try:
            yield folder
        except OSError as error:
            if error.filename and Path(error.filename).parent == folder:
                error.filename = str(out / Path(error.filename).name)
            raise
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def publish(folder: Path, out: Path, is_finished: bool) -> Path:
    """Moves the files staged in `folder` to `out` together; returns where they are.

    What did not finish replaces no earlier performance: it goes to a folder of its own in `out`.
    Raises OSError, and leaves `out` as it was.
    """
    with alone_with(out):  # others publish in the same folder
        if not is_finished and (out / PERFORMANCE).exists():
            out = _fresh_folder(out)
        names = {path.name for path in folder.iterdir()}
        _exchange(folder, out, names | set(OF_A_CLIP) if PERFORMANCE in names else names)
    return out


def beside_capture(folder: Path, out: Path, name: str) -> None:
    """Has the report in `folder` called `name` if the folder that it goes to has a capture's."""
    if (out / PERFORMANCE).exists():
        (folder / "report.html").rename(folder / name)


def publish_files(folder: Path, out: Path) -> None:
    """As `publish`, of finished files of any names, and no other file in `out` goes."""
    with alone_with(out):
        _exchange(folder, out, {path.name for path in folder.iterdir()})


def _exchange(folder: Path, out: Path, going: set[str]) -> None:
    """going: names in `out` whose files make room for those in `folder`."""
    names = {path.name for path in folder.iterdir()}
    old_names = {name for name in going if (out / name).exists()}
    for name in old_names:
        check_replaceable(out / name)
    before = folder / HIDDEN
    before.mkdir()
    try:
        for name in sorted(old_names):
            os.rename(out / name, before / name)
        for name in sorted(names):
            os.rename(folder / name, out / name)
    except BaseException:  # a second Ctrl-C, too
        for name in names:
            if not (folder / name).exists():
                os.rename(out / name, folder / name)
        for path in before.iterdir():
            os.rename(path, out / path.name)
        raise


def _fresh_folder(out: Path) -> Path:
    for number in itertools.count(1):
        fresh = out / (UNFINISHED if number == 1 else f"{UNFINISHED}-{number}")
        with contextlib.suppress(FileExistsError):
            fresh.mkdir()
            return fresh
    raise AssertionError
