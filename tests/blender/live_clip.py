# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips that stand in for a camera in tests."""

import subprocess


def ffmpeg(*words):
    from imageio_ffmpeg import get_ffmpeg_exe

    subprocess.run([get_ffmpeg_exe(), "-v", "error", *words], check=True)
