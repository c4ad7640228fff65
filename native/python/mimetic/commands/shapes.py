# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic shapes`: ARKit's 52 blend shapes on a head of any make, by the Blender extension in a
child process."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from mimetic import InvalidInput
from mimetic.character.landmarks_file import read_landmarks
from mimetic.commands.bake import parse_target
from mimetic.commands.blender_process import add_blender_python, write_by_blender
from mimetic.shared.regular_file import check_target

SUFFIXES = (".blend", ".glb")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("head", metavar="HEAD.blend:OBJECT", help="the head's mesh")
    parser.add_argument("--out", type=Path, required=True, help="FILE.blend or FILE.glb")
    parser.add_argument(
        "--landmarks",
        type=Path,
        metavar="FILE.json",
        help="where the landmarks are, vertices or metres in the world (default: the file's own "
        "empties or vertex groups of their names, else they place themselves)",
    )
    add_blender_python(parser)


def run_shapes(arguments: argparse.Namespace) -> int:
    head = parse_target(arguments.head, "HEAD.blend:OBJECT")
    out = Path(os.path.realpath(arguments.out))
    if out.suffix not in SUFFIXES:
        raise InvalidInput(f"--out {out.name}: shapes writes {', '.join(SUFFIXES)} files")
    landmarks = arguments.landmarks
    if landmarks is not None:
        read_landmarks(landmarks)  # refused before Blender starts
        landmarks = str(landmarks.absolute())
    check_target(out, head["file"], *filter(None, [landmarks]))
    request = {"shapes": {**head, "landmarks": landmarks}}
    print(f"{arguments.out}: {write_by_blender(request, out, arguments.blender_python)}")
    return 0
