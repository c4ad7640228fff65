# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a walk of tests/window that measures, and prints its rows: WALK [FOOTAGE] [WIDTHxHEIGHT]."""

from __future__ import annotations

import os
import re
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "window"))
from blender_window import SIZE, BlenderFolder, Screen  # noqa: E402


def main(walk: str, *words: str) -> int:
    """words: a clip's file, and the window's size if it is not the tests'."""
    sizes = [tuple(map(int, w.split("x"))) for w in words if re.fullmatch(r"\d+x\d+", w)]
    footage = [word for word in words if not re.fullmatch(r"\d+x\d+", word)]
    extension = Path(os.environ["MIMETIC_WINDOW_EXTENSION"])
    work = Path(tempfile.mkdtemp(prefix="mimetic-window-", dir="/tmp"))
    pictures = ROOT / "out" / "window"
    pictures.mkdir(parents=True, exist_ok=True)
    try:
        for file in (extension, *footage):
            shutil.copy(file, work)
        with Screen(*sizes[:1] or [SIZE]) as screen:
            settings = {"extension": extension.name, "clip": "".join(Path(f).name for f in footage)}
            folder = BlenderFolder.prepared()
            findings = folder.walk(screen, walk, work, pictures, settings, 600)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    for name, value in findings.arrays.get("rows", []):
        print(f"{name:32} {value}")
    for failure in findings.failures():
        print(failure, file=sys.stderr)
    return 1 if findings.failures() else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
