# SPDX-License-Identifier: GPL-3.0-or-later
"""A file that the Blender extension writes, in a Blender without a window as a child process."""

from __future__ import annotations

import argparse
import contextlib
import errno
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.shared.whole_file import file_beside, file_with_textures

SCRIPT = "headless_bake.py"
# Free bytes below which a disk counts as full once Blender failed: twice what a face's .blend
# takes, as Blender removes what it could not finish; and of that of temporary files, which are few
LITTLE_SPACE, LITTLE_FOR_TEMPORARY = 16 << 20, 1 << 20


def add_blender_python(parser: argparse.ArgumentParser) -> None:
    """The option with which Blender runs."""
    parser.add_argument(
        "--blender-python",
        type=Path,
        metavar="PYTHON",
        help="a Python that has the bpy module (default: this one)",
    )


def write_by_blender(request: dict, out: Path, blender_python: os.PathLike[str] | None) -> str:
    """Writes `out`, whole or not at all; returns a line that says what is in it.

    Blender works in a process of its own on a file beside `out`, and ends when this one ends: only
    this process puts the file in its place. request: what the extension's SCRIPT is to write, as
    JSON has it; blender_python: a Python with the bpy module, this one if None. Raises
    InvalidInput, UnreadableMedia, and OSError where `out` cannot be written.
    """
    python = blender_python or python_with_blender()
    with (
        tempfile.TemporaryDirectory(prefix="mimetic-bake-") as folder,
        _file_for_blender(out) as (aside, its_folder),
    ):
        whole = request | {
            "out": str(aside),
            "its_folder": its_folder,
            "package_folder": str(Path(__file__).absolute().parents[2]),
            "answer": str(Path(folder, "answer.json")),
        }
        answer = _ask(python, whole, Path(folder))
        if "failed" in answer:
            raise _refused(answer, str(aside), str(out))
        if "error" in answer:
            raise InvalidInput(answer["error"].replace(str(aside), str(out)))
    return answer["text"]


def _refused(answer: dict, aside: str, out: str) -> OSError:
    """What the system refused to Blender, which wrote `aside`; as if of `out`."""
    text = answer["failed"].replace(aside, out)
    if answer["number"] is None:
        return OSError(text)
    file = answer["file"]
    return OSError(answer["number"], text, None if file is None else file.replace(aside, out))


def python_with_blender() -> str:
    """This Python, if it has the bpy module; raises InvalidInput if not."""
    if importlib.util.find_spec("bpy") is None:
        raise InvalidInput(
            "Blender as a Python module (bpy) is missing here: pip install 'mimetic[blender]', "
            "or name a Python that has it by --blender-python"
        )
    return sys.executable


def extension_folder() -> Path:
    """Where the extension's sources are: beside this file when installed, else in the checkout."""
    here = Path(__file__).absolute()
    for folder in (here.parents[1] / "blender_addon", here.parents[4] / "blender_addon"):
        if (folder / SCRIPT).is_file():
            return folder
    raise UnreadableMedia(f"{here.parent}: the Blender extension is missing; install Mimetic again")


@contextlib.contextmanager
def _file_for_blender(out: Path) -> Iterator[tuple[Path, str]]:
    """The file that Blender writes, and the folder that it alone is in, if it is."""
    if out.suffix != ".blend":
        with file_with_textures(out) as aside:
            yield aside, str(aside.parent)
        return
    # Beside `out`, where the relative paths in it hold
    with file_beside(out, out.suffix) as aside:
        try:
            yield aside, ""
        finally:
            _remove_left_beside(aside)


def _remove_left_beside(aside: Path) -> None:
    """Removes what a Blender that was ended left: files and folders named after `aside`."""
    for left in aside.parent.glob(f".{aside.stem}.*"):
        if left.is_dir():
            shutil.rmtree(left, ignore_errors=True)
        else:
            left.unlink(missing_ok=True)


def _ask(python: os.PathLike[str] | str, request: dict, folder: Path) -> dict:
    """Runs the child, with `folder` for all that it keeps for a while; returns its answer."""
    # Isolated (-I): nothing of the caller's environment or folder changes what is imported
    command = [os.fspath(python), "-I", str(extension_folder() / SCRIPT)]
    log = folder / "blender.log"
    try:
        with open(log, "wb") as stream:
            process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=stream,
                stderr=subprocess.STDOUT,
                env={**os.environ, "TMPDIR": str(folder)},
                start_new_session=True,  # Ctrl-C is ours to handle
            )
    except OSError as error:
        raise UnreadableMedia(f"--blender-python {python}: {error.strerror}") from None
    requests = process.stdin
    assert requests is not None  # a pipe, as requested
    try:
        # Standard input stays open while this process lives: the child ends when it closes
        with contextlib.suppress(BrokenPipeError):
            requests.write(json.dumps(request).encode() + b"\n")
            requests.flush()
        process.wait()
    finally:
        process.kill()
        process.wait()
        with contextlib.suppress(BrokenPipeError):
            requests.close()
    answer = Path(request["answer"])
    if process.returncode == 0 and answer.exists():
        return json.loads(answer.read_text(encoding="utf-8"))
    output = log.read_text(encoding="utf-8", errors="replace")
    if "No module named 'bpy'" in output:
        raise InvalidInput(
            f"--blender-python {python} has no Blender module: pip install bpy in it"
        )
    raise _failure(process.returncode, output, request)


def _failure(status: int, output: str, request: dict) -> OSError:
    """Why Blender ended without an answer: a full disk, where there is one, and its last lines."""
    # But for the marks below a traceback's lines, which mean nothing in one line
    lines = [line for line in output.strip().splitlines() if line.strip(" ^~")]
    said = f"Blender failed (exit status {status}):\n" + "\n".join(lines[-12:])
    copied = (request.get(kind) for kind in ("target", "shapes"))
    sizes = [os.stat(source["file"]).st_size for source in copied if source]
    temporary = Path(request["answer"]).parent
    for folder, needed, name in (
        (Path(request["out"]).parent, max([LITTLE_SPACE, *sizes]), None),  # that of the result
        (temporary, LITTLE_FOR_TEMPORARY, str(temporary.parent)),
    ):
        free = shutil.disk_usage(folder).free
        if free < needed:
            why = f"{os.strerror(errno.ENOSPC)}, as it seems ({free / 1e6:.1f} MB are free)"
            return OSError(
                errno.ENOSPC, f"{why}; free some, or choose another folder. {said}", name
            )
    return OSError(said)
