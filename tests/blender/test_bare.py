# SPDX-License-Identifier: GPL-3.0-or-later
"""The zip in a bare folder: Blender's own Python, no other package, program or network."""

import json
import os
import shutil
import site
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import ROOT

pytestmark = pytest.mark.oldest_and_newest
HERE = Path(__file__).parent
# What a bpy environment of ours has and Blender has not
OURS = ("mimetic", "imageio", "pytest", "_pytest", "pip", "pluggy", "iniconfig", "packaging")


@pytest.fixture(scope="module")
def zip_file() -> Path:
    files = list((ROOT / "dist").glob("mimetic-*-linux_x64.zip"))
    assert len(files) == 1, "run scripts/build_extension"
    return files[0]


@pytest.fixture
def bare(tmp_path) -> Path:
    """A folder with Blender's module and what it needs, and nothing else."""
    packages = tmp_path / "packages"
    packages.mkdir()
    # Of those that Python names some need not be there: Debian's are beside a venv's own
    for folder in filter(Path.is_dir, map(Path, site.getsitepackages())):
        for entry in folder.iterdir():
            if not entry.name.lower().startswith(OURS) and entry.suffix != ".pth":
                (packages / entry.name).symlink_to(entry)
    assert (packages / "bpy").exists() and not list(packages.glob("mimetic*"))
    return tmp_path


def without_network() -> list[str]:
    """A prefix of the command, where the system permits it; a hook in the script forbids it too."""
    unshare = shutil.which("unshare")
    allowed = (
        unshare and subprocess.run([unshare, "-n", "true"], capture_output=True).returncode == 0
    )
    return [unshare, "-n"] if allowed else []


def test_the_zip_alone_installs_captures_bakes_and_exports(zip_file, bare, clip_path):
    clip = bare / "clip.mkv"
    shutil.copy(clip_path, clip)
    (bare / "empty").mkdir()
    request = {"zip": str(zip_file), "clip": str(clip), "packages": str(bare / "packages")}
    ran = subprocess.run(
        # -I, -S: no PYTHONPATH, no user's packages, no site-packages
        [
            *without_network(),
            sys.executable,
            "-I",
            "-S",
            HERE / "bare_walk.py",
            json.dumps(request),
        ],
        cwd=bare,
        env={"PATH": str(bare / "empty"), "HOME": str(bare), "TMPDIR": str(bare)},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert (bare / "answer.json").exists(), ran.stdout[-2000:] + ran.stderr[-2000:]
    answer = json.loads((bare / "answer.json").read_text())
    assert answer["network"] == []
    assert Path(answer["package"]).is_relative_to(bare)
    assert answer["captured"] == 12 and answer["num_curves"] > 36
    assert Path(answer["glb"]).stat().st_size > 100_000
    assert os.path.exists(answer["take"])


@pytest.mark.newest
def test_pip_installs_the_wheel_where_nothing_is_and_it_captures(clip_path, tmp_path):
    """A new environment, away from the checkout; numpy, ffmpeg and matplotlib come from PyPI."""
    tag = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    (wheel,) = (ROOT / "build" / "wheels").glob(f"mimetic-*{tag}[.-]*.whl")
    clip = tmp_path / "clip.mkv"
    shutil.copy(clip_path, clip)
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "env"], check=True)
    # Python compiles what is imported; pip would compile all, matplotlib's tests too
    command = [sys.executable, "-m", "pip", "--python", tmp_path / "env/bin/python", "install"]
    command += ["--quiet", "--no-compile", f"{wheel}[report]"]
    installed = subprocess.run(command, capture_output=True, text=True, check=False)
    if "No matching distribution found" in installed.stderr:
        pytest.skip("no package registry can be reached")
    assert installed.returncode == 0, installed.stderr
    ran = subprocess.run(
        [tmp_path / "env/bin/mimetic", "capture", clip, "--frames", "1:12", "--out", "take"],
        cwd=tmp_path,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    assert {"performance.npz", "overlay.mp4", "report.html", "fit.json"} == {
        path.name for path in (tmp_path / "take").iterdir()
    }
