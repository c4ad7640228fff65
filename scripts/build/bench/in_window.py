# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a walk of tests/window that measures, and prints its rows: WALK [FOOTAGE]."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "window"))
from blender_window import BlenderFolder, Screen  # noqa: E402


def main(walk: str, *footage: str) -> int:
    extension = Path(os.environ["MIMETIC_WINDOW_EXTENSION"])
    work = Path(tempfile.mkdtemp(prefix="mimetic-window-", dir="/tmp"))
    pictures = ROOT / "out" / "window"
    pictures.mkdir(parents=True, exist_ok=True)
    try:
        for file in (extension, *footage):
            shutil.copy(file, work)
        with Screen() as screen:
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
