# SPDX-License-Identifier: GPL-3.0-or-later
"""A job's thread, and what it tells the window: how far it is, what it made, why it failed."""

from __future__ import annotations

import os
import queue
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from . import native

TELLING = 0.02  # of the work, from which on the time left is told
GIVES_WAY = 3  # nice value that the thread of a job adds: docs/measured/addon.md


@dataclass
class Run:
    """One job at work, or waiting for its turn. The worker posts, the main thread reads."""

    label: str
    subject: str = ""  # the clip that it works on
    begin: Callable[[], None] | None = None  # when its turn comes; None: it has yet to be read
    keeps_part: bool = False  # when it is stopped
    is_endless: bool = False  # it runs until it is stopped
    so_far: object = None  # a mimetic.solve.frames_so_far.FramesSoFar, drawn while it grows
    posts: queue.SimpleQueue = field(default_factory=queue.SimpleQueue)
    stop: threading.Event = field(default_factory=threading.Event)
    thread: threading.Thread | None = None
    fraction: float = 0.0
    what: str = ""
    result: object = None
    error: BaseException | None = None
    begun: float = 0.0

    def start(self, work, inputs) -> None:
        def target() -> None:
            _give_way()
            try:
                self.posts.put(("result", work(inputs, self.progress)))
            except BaseException as error:
                self.posts.put(("error", error))

        # A daemon: Blender must be able to quit while the work goes on
        self.begun = time.monotonic()
        self.thread = threading.Thread(target=target, name=self.label, daemon=True)
        self.thread.start()

    def progress(self, fraction: float, what: str = "") -> bool:
        """Called by the worker; says whether to go on."""
        self.posts.put(("progress", (fraction, what)))
        return not self.stop.is_set()

    def is_done(self) -> bool:
        """Reads what the worker posted; true once it ended."""
        if self.thread is None:
            return False
        while self.thread.is_alive() or not self.posts.empty():
            try:
                kind, value = self.posts.get_nowait()
            except queue.Empty:
                return False
            if kind == "progress":
                self.fraction, self.what = value
            else:
                setattr(self, kind, value)
                self.thread.join()
        return True

    def name(self) -> str:
        return f"{self.label}, {self.subject}" if self.subject else self.label

    def text(self) -> str:
        if self.is_endless:
            return f"{self.label}: {iface_(self.what)}"
        text = f"{self.label}: {self.fraction:.0%} {iface_(self.what)}".rstrip()
        return f"{text}{self._time_left()}"

    def short_text(self) -> str:
        """Without the step that it is at: as long as a sidebar is wide."""
        return f"{self.label}: {self.fraction:.0%}{self._time_left()}"

    def _time_left(self) -> str:
        if not TELLING <= self.fraction < 1:
            return ""
        left = int((time.monotonic() - self.begun) * (1 - self.fraction) / self.fraction)
        return iface_(", {minutes}:{seconds:02d} left").format(
            minutes=left // 60, seconds=left % 60
        )


def scene_name(uid: int) -> str:
    """Of a scene by its `session_uid`; nothing once it was deleted."""
    return next((scene.name for scene in bpy.data.scenes if scene.session_uid == uid), "")


def check_scene(uid: int) -> None:
    """Raises InvalidInput where a scene was deleted since a job in it began."""
    if not scene_name(uid):
        raise native.invalid_input(
            rpt_("The scene that this belongs to was deleted meanwhile; nothing was changed")
        )


def have_blender_ask(label: str) -> None:
    """Before it closes, which it does for a file that is not saved as it is.

    Nothing can hold Blender up from Python. A step without a change says that there is something
    to save, also after the file was saved in the middle; undoing the job's result leads to it.
    """
    if not bpy.data.is_dirty:
        bpy.ops.ed.undo_push(message=iface_("{job} Begun").format(job=label))


def _give_way() -> None:
    """Lets the window be drawn first where there are fewer processors than work.

    A nice value is a thread's own on Linux alone, where the threads that it starts have it, too.
    """
    if sys.platform == "linux":
        os.nice(GIVES_WAY)
