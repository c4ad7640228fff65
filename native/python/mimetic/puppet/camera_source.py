# SPDX-License-Identifier: GPL-3.0-or-later
"""A camera by an ffmpeg process of its own; it may stall, be unplugged, change its pictures."""

from __future__ import annotations

import os
import re
import sys
import threading
from collections import deque
from time import monotonic

import numpy as np

from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.ffmpeg import ffmpeg_program
from mimetic.media.ffmpeg_process import Running, fill, running
from mimetic.puppet.pictures import Events, NewestPicture, Picture

DEFAULT_SIZE, DEFAULT_RATE = (640, 480), 30
STALLED = 2.0  # seconds without a picture, after which it is said
GIVEN_UP = 8.0  # seconds without a picture, after which the camera is opened again
PATIENCE = 30.0  # seconds in which a camera that went away may come back
RETRY = 1.0  # seconds between tries to open it
SHOWN_SIZE = re.compile(rb"Parsed_showinfo.* s:(\d+)x(\d+) ")
PREFIX = "camera:"
# ffmpeg's words -> what to do
REASONS = (
    ("Permission denied", "no permission to use it; allow it in the system's settings"),
    ("not authorized", "no permission to use it; allow it in the system's privacy settings"),
    ("Operation not permitted", "no permission to use it; allow it in the system's settings"),
    ("Device or resource busy", "another program uses it; close that one"),
    ("No such file or directory", "there is no such {device}; is it plugged in?"),
    ("No such device", "there is no such {device}; is it plugged in?"),
    ("Could not find video device", "there is no such {device}; is it plugged in?"),
    ("Inappropriate ioctl", "that is no {device}"),
    ("Not a video capture device", "that is no {device}"),
    ("Unknown input format", "this ffmpeg reads no {device}s; name another in IMAGEIO_FFMPEG_EXE"),
)


def is_camera(name: str) -> bool:
    """Whether a source is named as cameras are: camera:0, camera:NAME, /dev/video0."""
    return name.startswith((PREFIX, "/dev/video"))


class CameraSource:
    """A camera's pictures as they come, fitted into `size` with black beside them.

    name: camera:0 and so on, camera:NAME as the system has it, or on Linux /dev/videoN. patience:
    seconds in which a camera that went away may come back. Raises InvalidInput.
    """

    def __init__(
        self,
        name: str,
        size: tuple[int, int] = DEFAULT_SIZE,
        fps: int = DEFAULT_RATE,
        patience: float = PATIENCE,
    ) -> None:
        self.name, self.size, self.fps, self.patience = name, size, float(fps), patience
        self._input = camera_input(name, sys.platform)
        self._start: float | None = None
        self._shown: tuple[int, int] | None = None  # what the camera itself gives
        self._is_changed = False

    def time_of(self, frame: int) -> float:
        return (frame - 1) / self.fps

    def feed(self, pictures: NewestPicture, events: Events) -> None:
        """Raises UnreadableMedia where it cannot be opened, or went away and did not come back."""
        self._start = None
        gone_since: float | None = None
        while not events.is_stopped:
            num_before = pictures.num_put
            reason = self._read(pictures, events)
            if events.is_stopped:
                return
            if self._start is None:
                raise UnreadableMedia(f"{self.name}: {reason}")
            now = monotonic()
            if pictures.num_put > num_before or gone_since is None:
                gone_since = now
                events.say(f"{self.name} went away ({reason}); waiting for it to come back")
            if now - gone_since > self.patience:
                raise UnreadableMedia(
                    f"{self.name} did not come back within {self.patience:g} s ({reason})"
                )
            events.wait(RETRY)

    def _read(self, pictures: NewestPicture, events: Events) -> str:
        """Reads until the camera ends, and says why it did."""
        width, height = self.size
        with running(self._command(), on_line=self._see_size) as ffmpeg:
            watch = _StallWatch(ffmpeg, self.name, events)
            is_first = True
            while not events.is_stopped:
                image = np.empty((height, width, 3), np.uint8)
                if not fill(ffmpeg.output, image):
                    break
                watch.saw_picture()
                now = monotonic()
                if is_first and self._start is not None:
                    events.say(f"{self.name} is back")
                is_first = False
                self._start = now if self._start is None else self._start
                pictures.put(Picture(image, now - self._start, now, self._take_change(events)))
            watch.end()
        return "it gave no picture" if watch.is_given_up else reason_of(ffmpeg.errors)

    def _command(self) -> list[str]:
        width, height = self.size
        fitted = f"scale={width}:{height}:force_original_aspect_ratio=decrease"
        beside = f"pad={width}:{height}:(ow-iw)/2:(oh-ih)/2,setsar=1"
        filled = dict(width=width, height=height, rate=round(self.fps))
        return [
            *(ffmpeg_program(), "-nostdin", "-hide_banner", "-v", "info", "-nostats"),
            *("-fflags", "nobuffer", "-flags", "low_delay"),
            *(word.format(**filled) for word in self._input),
            *("-map", "0:v:0", "-vf", f"showinfo=checksum=0,{fitted},{beside}"),
            *("-fps_mode", "passthrough", "-pix_fmt", "rgb24", "-f", "rawvideo", "pipe:1"),
        ]

    def _see_size(self, line: bytes) -> bool:
        """In ffmpeg's thread: the size of a frame as the camera gives it."""
        if match := SHOWN_SIZE.search(line):
            size = int(match[1]), int(match[2])
            if self._shown is not None and size != self._shown:
                self._is_changed = True
            self._shown = size
        return b"showinfo" in line

    def _take_change(self, events: Events) -> bool:
        is_changed, self._is_changed = self._is_changed, False
        if is_changed and self._shown:
            width, height = self._shown
            events.say(
                f"{self.name} gives pictures of {width} x {height} now; the face is found anew"
            )
        return is_changed


class _StallWatch:
    """Says when an ffmpeg gives no pictures, and ends one that gives none for long."""

    def __init__(self, ffmpeg: Running, name: str, events: Events) -> None:
        self._ffmpeg, self._name, self._events = ffmpeg, name, events
        self._last, self._is_stalled = monotonic(), False
        self._has_begun = False  # a camera takes its time to open
        self.is_given_up = False
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def saw_picture(self) -> None:
        self._last, self._has_begun = monotonic(), True
        if self._is_stalled:
            self._is_stalled = False
            self._events.say(f"{self._name} gives pictures again")

    def end(self) -> None:
        self._ended.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._ended.wait(0.05):
            silent = monotonic() - self._last
            if self._has_begun and silent > STALLED and not self._is_stalled:
                self._is_stalled = True
                self._events.say(f"{self._name} gives no picture for {STALLED:g} s; waiting")
            self.is_given_up = silent > GIVEN_UP
            if self.is_given_up or self._events.is_stopped:
                self._ffmpeg.process.kill()
                return


def camera_input(name: str, platform: str) -> list[str]:
    """ffmpeg's words for a camera; {width}, {height} and {rate} are to be filled in.

    platform: as `sys.platform`. Raises InvalidInput.
    """
    device = name.removeprefix(PREFIX)
    if not device or device.startswith("-") or any(ord(letter) < 32 for letter in device):
        raise InvalidInput(f"{name!r} names no camera; give camera:0, camera:1 and so on")
    wishes = ["-framerate", "{rate}", "-video_size", "{width}x{height}"]
    device = device.replace("{", "{{").replace("}", "}}")
    if platform == "darwin":
        return ["-f", "avfoundation", *wishes, "-i", f"{device}:none"]
    if platform == "win32":
        if device.isdigit():
            raise InvalidInput(
                f"{name}: Windows knows cameras by name; give camera:NAME as the device manager "
                "shows it"
            )
        return ["-f", "dshow", *wishes, "-i", f"video={device}"]
    path = f"/dev/video{device}" if device.isdigit() else device
    if not re.fullmatch(r"/dev/[\w./-]+", path) or ".." in path:
        raise InvalidInput(f"{name}: on Linux a camera is camera:0 or /dev/video0")
    return ["-f", "v4l2", *wishes, "-i", path]


def reason_of(lines: deque[bytes], device: str = "camera") -> str:
    """Why ffmpeg ended, from its last lines."""
    text = b"\n".join(lines).decode(errors="replace")
    for words, reason in REASONS:
        if words in text:
            return reason.format(device=device)
    last = os.fsdecode(lines[-1]) if lines else "unplugged?"
    return re.sub(r"^\[[^]]*\] *", "", last)[:120]
