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

    is_paced: false gives each frame as soon as the one before is taken, and skips none; is_looped:
    begins again at its end, without end. Raises UnreadableMedia.
    """

    def __init__(
        self, path: str | os.PathLike[str], is_paced: bool = True, is_looped: bool = False
    ) -> None:
        self.footage = Footage(path)
        self.name = self.footage.path.name
        self.size, self.fps = self.footage.size, float(self.footage.fps)
        self.is_paced, self.is_looped = is_paced, is_looped

    def time_of(self, frame: int) -> float:
        return self.footage.time_of(frame)

    def feed(self, pictures: NewestPicture, events: Events) -> None:
        self._start, self._played = monotonic(), 0.0  # seconds of the rounds before
        while self._play(pictures, events):
            if not self.is_looped:
                for warning in self.footage.warnings:
                    events.say(warning)
                return

    def _play(self, pictures: NewestPicture, events: Events) -> bool:
        """Once; false where it is to stop."""
        time = self._played
        for frame, image in self.footage.frames():
            time = self._played + self.time_of(frame)
            left = self._start + time - monotonic()
            if events.is_stopped or (self.is_paced and events.wait(left)):
                return False
            picture = Picture(np.ascontiguousarray(image), time, monotonic())
            pictures.put(picture, waits=not self.is_paced)
        self._played = time + 1 / self.fps
        return True
