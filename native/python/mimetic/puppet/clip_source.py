# SPDX-License-Identifier: GPL-3.0-or-later
"""A clip at its own speed in place of a camera."""

from __future__ import annotations

import os
from time import monotonic

import numpy as np

from mimetic.media.footage import Footage
from mimetic.puppet.pictures import Events, NewestPicture, Picture


class ClipSource:
    """The frames of a video file, when they are due.

    is_paced: false gives each frame as soon as the one before is taken, and skips none. Raises
    UnreadableMedia.
    """

    def __init__(self, path: str | os.PathLike[str], is_paced: bool = True) -> None:
        self.footage = Footage(path)
        self.name = self.footage.path.name
        self.size, self.fps = self.footage.size, float(self.footage.fps)
        self.is_paced = is_paced

    def feed(self, pictures: NewestPicture, events: Events) -> None:
        start = monotonic()
        for frame, image in self.footage.frames():
            times = self.footage.times
            time = float(times[frame - 1]) if frame <= len(times) else (frame - 1) / self.fps
            if events.is_stopped or (self.is_paced and events.wait(start + time - monotonic())):
                return
            picture = Picture(np.ascontiguousarray(image), time, monotonic())
            pictures.put(picture, waits=not self.is_paced)
        for warning in self.footage.warnings:
            events.say(warning)
