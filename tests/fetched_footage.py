# SPDX-License-Identifier: GPL-3.0-or-later
"""Real footage for tests, fetched where it is missing."""

import subprocess
import sys
from pathlib import Path

import pytest
from imageio_ffmpeg import get_ffmpeg_exe

ROOT = Path(__file__).resolve().parents[1]
FETCH = ROOT / "scripts" / "fetch_footage"
UNREACHABLE = 3  # its exit status without a network


def fetched_clip(name: str, folder: Path = ROOT / "build" / "footage") -> Path:
    """One of the clips that scripts/fetch_footage names; skips the test without a network."""
    path = folder / name
    if not path.is_file():
        ran = subprocess.run([sys.executable, FETCH], capture_output=True, text=True, check=False)
        if ran.returncode == UNREACHABLE and not path.is_file():
            pytest.skip("the footage cannot be fetched: no registry can be reached")
        assert path.is_file(), f"{name} was not fetched: {ran.stdout}{ran.stderr}"
    return path


def fetched_frames(name: str, first: int, last: int, folder: Path) -> Path:
    """These frames of a fetched clip, without loss, as a clip of their own in the folder.

    What the other frames say of a head takes far longer to find than what these do.
    """
    path = folder / f"{Path(name).stem}_{first}_{last}.mkv"
    cut = f"trim=start_frame={first - 1}:end_frame={last},setpts=PTS-STARTPTS"
    command = [get_ffmpeg_exe(), "-v", "error", "-y", "-i", str(fetched_clip(name))]
    subprocess.run([*command, "-an", "-vf", cut, "-c:v", "ffv1", str(path)], check=True)
    return path
