# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic bake`: a performance as .glb or .blend, by the Blender extension in a child process."""

from __future__ import annotations

import argparse
import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.pose_smoothing import USUAL_STRENGTH

SUFFIXES = (".glb", ".blend")
SCRIPT = "headless_bake.py"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument("--out", type=Path, required=True, help="FACE.glb or FACE.blend to write")
    parser.add_argument(
        "--footage",
        type=Path,
        help="the captured clip: its colours on the skin, and the clip behind the face",
    )
    parser.add_argument(
        "--target",
        metavar="RIG.blend:OBJECT",
        help="put the head's motion on this object or armature instead, in a copy of its file",
    )
    parser.add_argument(
        "--detail",
        action="store_true",
        help="shapes and curves for what the muscles leave unexplained too",
    )
    parser.add_argument("--bone", help="the armature's head (default: found by its name)")
    parser.add_argument(
        "--neck", help="the armature's neck (default: found by its name; '' for none)"
    )
    parser.add_argument(
        "--neck-share", type=float, default=0.3, help="part of the turns that the neck takes"
    )
    parser.add_argument(
        "--smoothing",
        type=float,
        default=USUAL_STRENGTH,
        help="of the head's motion on a target: how far poses are doubted, in their own standard "
        "deviations (default: %(default)s; 0 keeps them)",
    )
    parser.add_argument(
        "--blender-python",
        type=Path,
        metavar="PYTHON",
        help="a Python that has the bpy module (default: this one)",
    )


def run_bake(arguments: argparse.Namespace) -> int:
    target = None
    if arguments.target:
        target = parse_target(arguments.target)
        target["settings"] = {
            "bone": arguments.bone,
            "neck": arguments.neck,
            "neck_share": arguments.neck_share,
            "smoothing": arguments.smoothing,
        }
        if arguments.detail:
            raise InvalidInput("--detail is of the person's own face; a --target takes the head")
    elif arguments.bone or arguments.neck:
        raise InvalidInput("--bone and --neck name bones of a --target RIG.blend:OBJECT; give it")
    text = bake(
        *(arguments.performance, arguments.out, arguments.footage, arguments.blender_python),
        target,
        arguments.detail,
    )
    print(f"{arguments.out}: {text}")
    return 0


def parse_target(text: str) -> dict:
    """The file and the object of RIG.blend:OBJECT."""
    path, _, name = text.rpartition(":")
    if not path.endswith(".blend") or not name:
        raise InvalidInput(f"--target {text}: give it as RIG.blend:OBJECT")
    if not Path(path).is_file():
        raise UnreadableMedia(f"--target {path}: there is no such file")
    return {"file": str(Path(path).absolute()), "object": name}


def bake(
    performance: os.PathLike[str],
    out: os.PathLike[str],
    footage: os.PathLike[str] | None = None,
    blender_python: os.PathLike[str] | None = None,
    target: dict | None = None,
    with_detail: bool = False,
) -> str:
    """Writes `out`, whole or not at all; returns a line that says what is in it.

    blender_python: a Python with the bpy module, this one if None. target: what `parse_target`
    gives, with `settings` for the head's motion on it; None bakes the person's own face.
    with_detail: shapes and curves of the surface that the muscles leave unexplained too.
    Raises InvalidInput, UnreadableMedia, and OSError where `out` cannot be written.
    """
    out = Path(out).absolute()
    if out.suffix not in SUFFIXES:
        raise InvalidInput(f"--out {out.name}: bake writes {' and '.join(SUFFIXES)} files")
    if target and out.suffix != ".blend":
        raise InvalidInput(f"--out {out.name}: a target is written as .blend")
    if not out.parent.is_dir():
        raise UnreadableMedia(f"--out {out}: there is no folder {out.parent}")
    for given in (performance, footage):
        if given is not None and not Path(given).exists():
            raise UnreadableMedia(f"{given}: there is no such file")
    python = blender_python or python_with_blender()
    with tempfile.TemporaryDirectory(prefix="mimetic-bake-") as folder:
        request = {
            "performance": str(Path(performance).absolute()),
            "out": str(out),
            "footage": None if footage is None else str(Path(footage).absolute()),
            "package_folder": str(Path(__file__).absolute().parents[1]),
            "target": target,
            "with_detail": with_detail,
            "answer": str(Path(folder, "answer.json")),
        }
        answer = _ask(python, request)
    if "error" in answer:
        raise InvalidInput(answer["error"])
    return answer["text"]


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
    for folder in (here.parent / "blender_addon", here.parents[3] / "blender_addon"):
        if (folder / SCRIPT).is_file():
            return folder
    raise UnreadableMedia(f"{here.parent}: the Blender extension is missing; install Mimetic again")


def _ask(python: os.PathLike[str] | str, request: dict) -> dict:
    """Runs the child; returns its answer."""
    # Isolated (-I): nothing of the caller's environment or folder changes what is imported
    command = [os.fspath(python), "-I", str(extension_folder() / SCRIPT)]
    try:
        ran = subprocess.run(
            command,
            input=json.dumps(request),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
    except OSError as error:
        raise UnreadableMedia(f"--blender-python {python}: {error.strerror}") from None
    answer = Path(request["answer"])
    if ran.returncode == 0 and answer.exists():
        return json.loads(answer.read_text(encoding="utf-8"))
    if "No module named 'bpy'" in ran.stdout:
        raise InvalidInput(
            f"--blender-python {python} has no Blender module: pip install bpy in it"
        )
    last_lines = "\n".join(ran.stdout.strip().splitlines()[-12:])
    raise OSError(f"Blender failed (exit status {ran.returncode}):\n{last_lines}")
