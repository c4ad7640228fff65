# SPDX-License-Identifier: GPL-3.0-or-later
"""Where live pictures come from, by what the user called it."""

from __future__ import annotations

from pathlib import Path

from mimetic.puppet.camera_source import CameraSource, is_camera
from mimetic.puppet.clip_source import ClipSource


def open_source(name: str, every_frame: bool) -> tuple[CameraSource | ClipSource, list[Path]]:
    """A camera, or a video file in its place; and the files that are read.

    every_frame: of a clip: none is skipped. Raises InvalidInput and UnreadableMedia.
    """
    if is_camera(name):
        return CameraSource(name), []
    clip = ClipSource(name, is_paced=not every_frame)
    return clip, [Path(clip.footage.path)]
