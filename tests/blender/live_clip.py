# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips that stand in for a camera in tests."""

import subprocess


def ffmpeg(*words):
    from imageio_ffmpeg import get_ffmpeg_exe

    subprocess.run([get_ffmpeg_exe(), "-v", "error", *words], check=True)


def play_without_end(extension, monkeypatch, path):
    """Sessions get this clip over and over, each picture as soon as there is time for it, however
    slow the machine is."""
    source = extension("native").live_source(False).ClipSource
    endless = source(path, is_paced=False, is_looped=True)
    monkeypatch.setattr(extension("live"), "source_of", lambda context, is_paced: endless)
