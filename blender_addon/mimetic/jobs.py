# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work: read the scene, work in a thread that knows no Blender, write once.

One job is at work at a time; those that may wait do so in the order in which they were pressed.
One that waits behind another on its clip reads what that one made when its turn comes. The window
stays free meanwhile: a job knows what it writes to by name, and looks when it does.
"""

from __future__ import annotations

import contextlib
import functools
import threading
from collections.abc import Iterator
from types import SimpleNamespace

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from . import carrying, editors, native, outcome, playback
from .greyed import Greyed
from .job_run import Run, check_scene, have_blender_ask, scene_name
from .pace import Pace

NOTHING_CHANGED = "Stopped; nothing was changed"

running: Run | None = None
waiting: list[Run] = []
_ending: list[threading.Thread] = []  # of jobs that Blender ended: they save what they have
_operators: list[Modal] = []  # that run on beside windows


def busy() -> str:
    """Why no other job may start, or the empty string."""
    return iface_("{job} is running; Esc stops it").format(job=running.label) if running else ""


def stop_running() -> None:
    """Asks the job at work to end and waits for it: the extension or Blender is going away.

    Blender may have ended its operator before; else it ends it without a word to it.
    """
    global running
    at_work = [one for one in _operators if one._run is running or one._run in waiting]
    waiting.clear()
    for thread in _ending:
        thread.join()
    _ending.clear()
    if running:
        running.stop.set()
        if running.thread:
            running.thread.join()
    for operator in at_work:
        operator.leave(bpy.context)
    running = None


def discard_running() -> None:
    """What Esc asks of the job at work."""
    if running.is_done():  # it waits for the scene to be ready
        running.result = None
    running.stop.set()


@contextlib.contextmanager
def _as_if_idle() -> Iterator[None]:
    """What is asked within is answered as if no job were at work."""
    global running
    at_work, running = running, None
    try:
        yield
    finally:
        running = at_work


def _take_turns(run: Run) -> None:
    """A run has ended, or waits no more: whose turn it is begins."""
    global running
    if run in waiting:
        waiting.remove(run)
    elif run is running:
        running = waiting.pop(0) if waiting else None
        if running and running.begin:
            running.begin()


def _drop_followers(subject: str) -> None:
    """Jobs that wait for what one on their clip was to make, and did not."""
    for run in (running, *waiting):
        if run and run.begin is None and run.subject == subject:
            _take_turns(run)


class Modal(Greyed):
    """Mixin of operators that run on beside the window until they `leave`; beside another one if
    theirs is closed: `invoke` asks `take_over` first.

    Subclasses give `handle(context, event)`, which returns what `modal` does. Where it raises,
    nothing of the operator stays behind either: no timer, no text, no run that blocks the next.
    """

    tick_seconds = 0.05
    _timer = None
    _run: Run | None = None
    _window = 0

    @classmethod
    def poll(cls, context):
        return carrying.is_handed_to(cls) or super().poll(context)

    def take_over(self, context) -> set[str]:
        """What `invoke` returns if it is to go on with what another operator was at, or nothing."""
        return self.enter(context, self._run) if carrying.take_over(self) else set()

    def enter(self, context, run: Run) -> set[str]:
        """With a run that has begun, or that waits."""
        global running
        if run not in waiting:
            running = run
        self._run, self._window = run, context.window.as_pointer()
        manager = context.window_manager
        self._timer = manager.event_timer_add(self.tick_seconds, window=context.window)
        manager.modal_handler_add(self)
        _operators.append(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        playback.note()
        if self._run is not running and self._run not in waiting:
            # It waits no more, or the extension was switched off underneath
            self.leave(context)
            return {"CANCELLED"}
        try:
            return self.handle(context, event)
        except BaseException:
            self._give_up(context)
            raise

    def cancel(self, context):
        """Blender ends the operator: its window was closed, or a file is loaded."""
        run = self._run
        if run and (run is running or run in waiting) and carrying.is_closed(self._window):
            self._remove_timer(context)
            go_on = functools.partial(_go_on, run, carrying.carried(self, run.subject))
            bpy.app.timers.register(go_on, first_interval=0.0, persistent=True)
        else:
            self._give_up(context)

    def _give_up(self, context) -> None:
        if self._run:
            _stop(self._run)
        self.leave(context)

    def leave(self, context) -> None:
        if self._run:
            _take_turns(self._run)
        self._remove_timer(context)
        for workspace in bpy.data.workspaces:  # another one may be on show by now
            workspace.status_text_set(None)
        _redraw()

    def _remove_timer(self, context) -> None:
        _operators[:] = [operator for operator in _operators if operator is not self]
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None


def _stop(run: Run) -> None:
    """Of an operator that is no more; what it has is kept."""
    run.stop.set()
    _ending[:] = [thread for thread in (*_ending, run.thread) if thread and thread.is_alive()]


def _go_on(run: Run, carried: carrying.Carried) -> None:
    """Beside another window, once its own is gone, if it was not ended meanwhile."""
    if run is not running and run not in waiting:
        return
    if not carrying.begin(carried):
        _stop(run)
        ended = SimpleNamespace(_run=run, _remove_timer=lambda _: None)
        carried.kind.leave(ended, bpy.context)


class Job(Modal):
    """Mixin of operators. Subclasses give read, work and write.

    `read(context)` and `write(context, result)` run on the main thread; `work(inputs, progress)`
    anywhere, without bpy, and returns what it has when `progress` returns False; its `self` may be
    the class alone. `write` returns the message for the user. No reference to Blender's data may
    pass from read to write.
    """

    keeps_part = False  # what a stopped job has done so far
    needs_object_mode = True  # to write
    tick_seconds = 0.02  # shorter than a drawing that `Pace` is to notice
    so_far: object = None  # what may be drawn meanwhile, made by `read`
    facts: dict | None = None  # what scripts are told `write` made, besides its message
    _scene = 0  # its session_uid: a name may change meanwhile
    _shown = ""
    _pace: Pace | None = None

    @classmethod
    def subject(cls, context) -> str:
        """The clip it works on, if it may wait while another job is at work."""
        return ""

    @classmethod
    def poll(cls, context):
        if running is None or cls._cannot_wait(context):
            return super().poll(context)
        with _as_if_idle():
            return super().poll(context)

    @classmethod
    def _cannot_wait(cls, context) -> str:
        """Why it cannot be pressed while another job is at work."""
        if running is None:
            return ""
        subject, label = cls.subject(context), cls._label()
        if not subject or running.is_endless:
            return busy()
        if any((run.subject, run.label) == (subject, label) for run in (running, *waiting)):
            return iface_("{job} is running or waits already").format(job=f"{label}, {subject}")
        return ""

    @classmethod
    def _label(cls) -> str:
        return iface_(cls.bl_label, "Operator")

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
        if begun := self.take_over(context):
            self._shown = ""  # in the status bar of the window before
            return begun
        if reason := self._cannot_wait(context):
            return outcome.cancelled(self, context, reason)
        run = Run(self._label(), self.subject(context), keeps_part=self.keeps_part)
        if not any(other and other.subject == run.subject for other in (running, *waiting)):
            try:
                inputs = self.read(context)
            except native.known_errors() as error:
                return outcome.cancelled(self, context, str(error))
            run.so_far = self.so_far
            run.begin = functools.partial(run.start, self._worker(), inputs)
        self._scene = context.scene.session_uid
        self._pace = Pace(self.tick_seconds)
        if running:
            waiting.append(run)
        else:
            run.begin()
        return self.enter(context, run)

    @classmethod
    def _worker(cls):
        """For the thread, which goes on when Blender ends the operator with its window."""
        return functools.partial(cls.work, cls)

    def _begin(self, context):
        """Its turn has come, behind another job on its clip, which has made what it reads."""
        run, reason = self._run, self._elsewhere(context)
        if reason and not run.stop.is_set():
            self._show(context, reason)
            return {"PASS_THROUGH"}
        try:
            if run.stop.is_set():
                raise native.invalid_input(rpt_(NOTHING_CHANGED))
            if self.needs_object_mode:
                check_scene(self._scene)
            if self.subject(context) != run.subject:
                raise native.invalid_input(
                    rpt_("{clip} is the clip no longer: {job} was not begun").format(
                        clip=run.subject, job=run.label
                    )
                )
            inputs = self.read(context)
        except native.known_errors() as error:
            self.leave(context)
            _drop_followers(run.subject)
            level = "WARNING" if run.stop.is_set() else "ERROR"
            return outcome.cancelled(self, context, str(error), level)
        run.so_far = self.so_far
        run.start(self._worker(), inputs)
        return {"PASS_THROUGH"}

    def handle(self, context, event):
        if event.type == "TIMER" and self._run is running:
            if running.thread is None:
                return self._begin(context)
            have_blender_ask(running.label)
            is_done = running.is_done()
            reason = self._hindrance(context) if is_done else ""
            if self._pace.is_due() and (self._show(context, reason) | self.accompany(context)):
                self._pace.has_shown()
            if is_done and not reason:
                return self._end(context)
        if not event.type.startswith("TIMER"):
            self._pace.has_input()
        # Esc that ends the playback is not meant for us
        if event.type == "ESC" and event.value == "PRESS" and not playback.was_on:
            discard_running()
            return {"RUNNING_MODAL"}
        return {"PASS_THROUGH"}

    def accompany(self, context) -> bool:
        """Called while it is at work, with what the worker has posted by now.

        Says whether it changed anything that Blender draws.
        """
        return False

    def _hindrance(self, context) -> str:
        """Why the result cannot be put into the scene as the window stands."""
        if running.stop.is_set() or running.error or not self.needs_object_mode:
            return ""
        if reason := self._elsewhere(context):
            return reason
        if context.mode != "OBJECT":
            return iface_("is done: go to Object Mode, where it is written")
        if playback.is_rendering():
            return iface_("is done: it is written when the render is")
        if editors.is_dragging():  # which is a step for undo of its own
            return iface_("is done: it is written when nothing is dragged")
        return ""

    def _elsewhere(self, context) -> str:
        own = scene_name(self._scene)
        if context.scene.session_uid == self._scene or not own:
            return ""
        return iface_("waits: go back to the scene {scene}, where it belongs").format(scene=own)

    def _end(self, context):
        run = running
        self.leave(context)
        try:
            if run.error:
                raise run.error
            is_stopped = run.stop.is_set()  # it may be done all the same
            result = run.result if run.keeps_part or not is_stopped else None
            if result is not None and self.needs_object_mode:
                check_scene(self._scene)  # no other scene is to get its objects
            answer = self._write(context, result, is_stopped)
        except native.known_errors() as error:
            if run.error and run.stop.is_set():  # it had nothing yet to keep
                answer = self._write(context, None, True)
            else:
                answer = outcome.cancelled(self, context, str(error))
        if answer == {"CANCELLED"}:
            _drop_followers(run.subject)
        return answer

    def _write(self, context, result, is_stopped: bool):
        if result is None:
            return outcome.cancelled(self, context, NOTHING_CHANGED, "WARNING")
        self.facts = {}
        message = self.write(context, result)
        facts = {**self.facts, "is_stopped": is_stopped}
        if is_stopped:
            message = rpt_("Stopped. {message}").format(message=rpt_(message))
            return outcome.finished(self, context, message, "WARNING", **facts)
        return outcome.finished(self, context, message, **facts)

    def _show(self, context, reason: str) -> bool:
        """Says whether anything is new."""
        if reason:
            text = iface_("{job} {reason}   |   Esc discards it").format(
                job=running.label, reason=reason
            )
        else:
            hint = iface_("stopping") if running.stop.is_set() else iface_("Esc stops")
            then = iface_("   |   {count} more").format(count=len(waiting)) if waiting else ""
            text = f"{running.text()}   |   {hint}{then}"
        if text == self._shown:
            return False
        self._shown = text
        context.workspace.status_text_set(text)
        _redraw()
        return True


def _redraw() -> None:
    """What shows how far jobs are: sidebars, and footage and time with what was followed."""
    editors.redraw_parts("WINDOW", *editors.OF_TAKES)
    editors.redraw_parts("UI", "CLIP_EDITOR", "VIEW_3D")
