# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work: read the scene, work in a thread that knows no Blender, write once."""

from __future__ import annotations

import queue
import threading
from dataclasses import dataclass, field

from . import editors, native, outcome
from .greyed import Greyed


@dataclass
class Run:
    """One job at work. The worker posts, the main thread reads."""

    label: str
    keeps_part: bool = False  # when it is stopped
    is_endless: bool = False  # it runs until it is stopped
    posts: queue.SimpleQueue = field(default_factory=queue.SimpleQueue)
    stop: threading.Event = field(default_factory=threading.Event)
    thread: threading.Thread | None = None
    fraction: float = 0.0
    what: str = ""
    result: object = None
    error: BaseException | None = None

    def start(self, work, inputs) -> None:
        def target() -> None:
            try:
                self.posts.put(("result", work(inputs, self.progress)))
            except BaseException as error:
                self.posts.put(("error", error))

        # A daemon: Blender must be able to quit while the work goes on
        self.thread = threading.Thread(target=target, name=self.label, daemon=True)
        self.thread.start()

    def progress(self, fraction: float, what: str = "") -> bool:
        """Called by the worker; says whether to go on."""
        self.posts.put(("progress", (fraction, what)))
        return not self.stop.is_set()

    def is_done(self) -> bool:
        """Reads what the worker posted; true once it ended."""
        while True:
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

    def text(self) -> str:
        if self.is_endless:
            return f"{self.label}: {self.what}"
        return f"{self.label}: {self.fraction:.0%} {self.what}".rstrip()


running: Run | None = None


def busy() -> str:
    """Why no other job may start, or the empty string."""
    return f"{running.label} is running; Esc stops it" if running else ""


def stop_running() -> None:
    """Asks the job at work to end and waits for it: the extension is going away."""
    global running
    if running:
        running.stop.set()
        running.thread.join()
        running = None


class Modal(Greyed):
    """Mixin of operators that run on beside the window, one at a time, until they `leave`.

    Subclasses give `handle(context, event)`, which returns what `modal` does. Where it raises,
    nothing of the operator stays behind either: no timer, no text, no run that blocks the next.
    """

    tick_seconds = 0.05
    _timer = None

    def enter(self, context, run: Run) -> set[str]:
        global running
        running = run
        manager = context.window_manager
        self._timer = manager.event_timer_add(self.tick_seconds, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if running is None:  # the extension was switched off underneath
            self.leave(context)
            return {"CANCELLED"}
        try:
            return self.handle(context, event)
        except BaseException:
            self.cancel(context)
            raise

    def cancel(self, context):
        """Blender ends the operator, as on loading a file."""
        if running:
            running.stop.set()
        self.leave(context)

    def leave(self, context) -> None:
        global running
        running = None
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if context.workspace is not None:
            context.workspace.status_text_set(None)


class Job(Modal):
    """Mixin of operators. Subclasses give read, work and write.

    `read(context)` and `write(context, result)` run on the main thread; `work(inputs, progress)`
    anywhere, without bpy, and returns what it has when `progress` returns False. `write` returns
    the message for the user. No reference to Blender's data may pass from read to write.
    """

    keeps_part = False  # what a stopped job has done so far
    facts: dict | None = None  # what scripts are told `write` made, besides its message

    def execute(self, context):
        """Blocks until done: scripts, batch and tests."""
        if reason := busy():
            return outcome.cancelled(self, context, reason)
        try:
            result = self.work(self.read(context), lambda fraction, what="": True)
            return self._write(context, result, False)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))

    def invoke(self, context, event):
        if context.window is None:
            return self.execute(context)
        if reason := busy():
            return outcome.cancelled(self, context, reason)
        try:
            inputs = self.read(context)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        run = Run(self.bl_label, self.keeps_part)
        run.start(self.work, inputs)
        return self.enter(context, run)

    def handle(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            running.stop.set()
        if event.type == "TIMER":
            is_done = running.is_done()
            self._show(context)
            if is_done:
                return self._end(context)
        # Every other event is blocked: an undo now would replace the scene that the job writes to
        return {"RUNNING_MODAL"}

    def _end(self, context):
        run = running
        self.leave(context)
        try:
            if run.error:
                raise run.error
            return self._write(context, run.result, run.stop.is_set())
        except native.known_errors() as error:
            if run.error and run.stop.is_set():  # it had nothing yet to keep
                return self._write(context, None, True)
            return outcome.cancelled(self, context, str(error))

    def _write(self, context, result, is_stopped: bool):
        if result is None:
            return outcome.cancelled(self, context, "Stopped; nothing was changed", "WARNING")
        self.facts = {}
        message = self.write(context, result)
        facts = {**self.facts, "is_stopped": is_stopped}
        if is_stopped:
            return outcome.finished(self, context, f"Stopped. {message}", "WARNING", **facts)
        return outcome.finished(self, context, message, **facts)

    def _show(self, context) -> None:
        stopping = "stopping" if running.stop.is_set() else "Esc stops"
        context.workspace.status_text_set(f"{running.text()}   |   {stopping}")
        editors.redraw("CLIP_EDITOR", "VIEW_3D")
