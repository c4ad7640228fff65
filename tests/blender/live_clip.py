# SPDX-License-Identifier: GPL-3.0-or-later
"""Clips that stand in for a camera in tests."""

import subprocess


def ffmpeg(*words):
    from imageio_ffmpeg import get_ffmpeg_exe

    subprocess.run([get_ffmpeg_exe(), "-v", "error", *words], check=True)


def play_unpaced(extension, monkeypatch, path, is_looped):
    """The next session gets each picture of this clip as soon as there is time for it, and none is
    left out, however slow the machine is; is_looped: over and over."""
    source = extension("native").live_source(False).ClipSource
    unpaced = source(path, is_paced=False, is_looped=is_looped)
    monkeypatch.setattr(extension("live"), "source_of", lambda context, is_paced: unpaced)
