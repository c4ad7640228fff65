# SPDX-License-Identifier: GPL-3.0-or-later
"""A face driven live in the viewport."""

import time

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty
from bpy.types import Operator

from .. import (
    editors,
    fast_view,
    jobs,
    live,
    live_looks,
    native,
    outcome,
    plural,
    scene_in,
    scene_out,
)
from ..greyed import Greyed
from ..live_settings import CHANNELS, MimeticLive
from ..overlay import session as session_view
from . import arguments
from .live_looks import MIMETIC_OT_keep_look

TOLD_EVERY = 0.5  # seconds
KEYS = {"N": "NEUTRAL", "R": "RECORD", "K": "KEEP", "ESC": "STOP"}
DIGITS = ("ONE", "TWO", "THREE", "FOUR", "FIVE")  # keys of the channels, in the panel's order
# What the viewport and the panels need; all else could change what the session writes to
PASSED = {
    *("MOUSEMOVE", "INBETWEEN_MOUSEMOVE", "LEFTMOUSE", "MIDDLEMOUSE", "WHEELUPMOUSE"),
    *("WHEELDOWNMOUSE", "WHEELINMOUSE", "WHEELOUTMOUSE", "TRACKPADPAN", "TRACKPADZOOM"),
    *("MOUSEROTATE", "TIMER_REPORT", "WINDOW_DEACTIVATE"),
}


# Of the panel, which a call may give
LIVE_SETTINGS = (
    *("source", "camera", "clip_path", "use_fit", "fit_path", "microphone", "driven"),
    *("taught_set", "set_use", "use_teaching", "stillness", "channels", "use_fast_view"),
    "countdown",
)


class MIMETIC_OT_live(jobs.Modal, Operator):
    """Drive the face by a camera, or by a clip in its place: N sets neutral, R records, K keeps a
    look, Esc stops. Without a window a whole clip is recorded"""

    bl_idname = "mimetic.live"
    bl_label = "Start Live"
    bl_options = {"UNDO"}

    source: arguments.like(MimeticLive, "source")
    camera: arguments.like(MimeticLive, "camera")
    clip_path: arguments.like(MimeticLive, "clip_path")
    use_fit: arguments.like(MimeticLive, "use_fit")
    fit_path: arguments.like(MimeticLive, "fit_path")
    microphone: arguments.like(MimeticLive, "microphone")
    driven: arguments.like(MimeticLive, "driven")
    taught_set: arguments.like(MimeticLive, "taught_set")
    set_use: arguments.like(MimeticLive, "set_use")
    use_teaching: arguments.like(MimeticLive, "use_teaching")
    stillness: arguments.like(MimeticLive, "stillness")
    channels: arguments.like(MimeticLive, "channels")
    use_fast_view: arguments.like(MimeticLive, "use_fast_view")
    countdown: arguments.like(MimeticLive, "countdown")

    tick_seconds = 1 / 60
    _told = 0.0

    obstacle = staticmethod(live.no_live)

    def execute(self, context):
        """Blocks until the clip has been worked through; every frame of it is recorded."""
        settings = context.scene.mimetic.live
        arguments.set_given(self, LIVE_SETTINGS, settings)
        if settings.source == "CAMERA":
            message = "A camera needs Blender's window; choose a clip as source"
            return outcome.cancelled(self, context, message)
        session = None
        try:
            session = _session(context, is_blocking=True)
            session.thread.start()
            if session.thread.error:
                raise session.thread.error
            message = live.end_take(context, session)
            session.notes = [*session.new_lines(), *session.notes]
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        finally:
            if session is not None:
                session.end()
        if not message:
            return outcome.cancelled(self, context, "No face was seen; nothing was changed")
        return _finished(self, context, session, message)

    def invoke(self, context, event):
        if context.window is None:
            return self.execute(context)
        if begun := self.take_over(context):
            return begun
        arguments.set_given(self, LIVE_SETTINGS, context.scene.mimetic.live)
        try:
            live.active = _session(context)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        live.active.view = session_view.SessionView(live.active.thread)
        live.active.thread.start()
        return self.enter(context, live.active.run)

    def handle(self, context, event):
        session = live.active
        is_pressed = event.value == "PRESS" and not event.is_repeat and not _has_modifier(event)
        if event.type in KEYS and is_pressed:
            session.commands.append(KEYS[event.type])
            return {"RUNNING_MODAL"}
        if event.type in DIGITS and is_pressed:
            channel = CHANNELS[DIGITS.index(event.type)][0]
            context.scene.mimetic.live.channels ^= {channel}
            self._told = 0.0  # the status bar says so at once
            return {"RUNNING_MODAL"}
        if event.type == "TIMER":
            return self._tick(context, session)
        # Undo would replace the scene that the session writes to
        return {"PASS_THROUGH"} if event.type in PASSED else {"RUNNING_MODAL"}

    def _tick(self, context, session):
        settings = context.scene.mimetic.live
        session.thread.set_stillness(settings.stillness)
        session.thread.set_frozen(live.frozen(settings))
        while session.commands:
            if self._obey(context, session, session.commands.pop(0)):
                return self._end(context, session)
        if session.due is not None and time.monotonic() >= session.due:
            live.begin_take(context, session)
        show(session)
        self._report_lines(session)
        if session.view is not None and session.view.has_news(settings):
            session_view.redraw()
        # What is shown is drawn by itself; lines of text cost as much, and are read more slowly
        if time.monotonic() - self._told >= TOLD_EVERY:
            self._told = time.monotonic()
            before, session.run.what = session.run.what, session.line()
            context.workspace.status_text_set(
                f"{session.run.text()}   |   {_hints(session, settings)}"
            )
            editors.redraw("VIEW_3D")
            if session.run.what != before:
                editors.redraw_parts("UI", "CLIP_EDITOR")
        if not session.thread.is_running:
            return self._end(context, session)
        return {"RUNNING_MODAL"}

    def _report_lines(self, session) -> None:
        for line in session.new_lines():
            self.report({"INFO"}, line)

    def _obey(self, context, session, command: str) -> bool:
        """Whether the session is to end."""
        if command == "NEUTRAL":
            session.thread.set_neutral()
            session.puppet.set_neutral()
        elif command == "RECORD" and (session.is_recording or session.due is not None):
            session.due = None
            self._end_take(context, session)
        elif command == "RECORD":
            session.due = time.monotonic() + context.scene.mimetic.live.countdown
        elif command == "KEEP":
            if reason := MIMETIC_OT_keep_look.obstacle(context):
                self.report({"WARNING"}, rpt_(reason))
                return False
            try:
                bpy.ops.mimetic.keep_look()
            except RuntimeError as error:  # of a name, for instance, that is none; it goes on
                self.report({"WARNING"}, outcome.told_by(error))
        return command == "STOP"

    def _end_take(self, context, session) -> None:
        """The session goes on."""
        try:
            message = live.end_take(context, session)
        except native.known_errors() as error:
            self.report({"WARNING"}, outcome.readable(str(error)))
        else:
            if message:
                self.report({"INFO"}, message)

    def _end(self, context, session):
        session.thread.stop()
        error, message = session.thread.error, ""
        try:
            message = live.end_take(context, session)
        except native.known_errors() as failure:
            error = error or failure
        finally:
            self._report_lines(session)  # of the take's end too: no tick comes after this one
            self.leave(context)
        if not session.takes:
            session.puppet.restore()
            if error and not isinstance(error, native.known_errors()):
                raise error
            if error:
                return outcome.cancelled(self, context, str(error))
            return outcome.cancelled(self, context, "Stopped; nothing was recorded", "INFO")
        if error:
            self.report({"WARNING"}, outcome.readable(str(error)))
        count = len(session.takes)
        recorded = plural.one_or_many(
            count, rpt_("1 take recorded"), rpt_("{count} takes recorded")
        )
        message = message or recorded.format(count=count)
        return _finished(self, context, session, message)

    def leave(self, context) -> None:
        session, live.active = live.active, None
        jobs.Modal.leave(self, context)
        if session is None:
            return
        try:
            live.keep_unfinished(session)
        finally:
            session.end()


class MIMETIC_OT_live_command(Greyed, Operator):
    """What the keys of a live session do: set neutral, record, stop"""

    bl_idname = "mimetic.live_command"
    bl_label = "Live"
    bl_options = {"INTERNAL"}

    command: EnumProperty(
        items=(
            ("NEUTRAL", "Set Neutral", "The face is at rest now"),
            ("RECORD", "Record", "Begin or end a take"),
            ("STOP", "Stop", "End the session; takes are kept"),
        ),
        description="What the session does",
    )

    @classmethod
    def obstacle(cls, context):
        return "" if live.active else "No live session runs"

    def execute(self, context):
        live.active.commands.append(self.command)
        return {"FINISHED"}


def _has_modifier(event) -> bool:
    """Whether the key is another one, such as Ctrl R, which means something else."""
    return event.ctrl or event.alt or event.shift or event.oskey


def show(session) -> None:
    """Puts the face as the newest picture has it, if there is a new one."""
    newest = session.thread.newest()
    if newest is not None:
        state, face = newest
        session.puppet.show(session.thread.names, state, face)


def _session(context, is_blocking: bool = False):
    settings = context.scene.mimetic.live
    source = live.source_of(context, is_paced=not is_blocking)
    run = jobs.Run(iface_("Live", "Operator"), is_endless=True)
    person = live.person_of(context)
    thread = native.puppet("live_thread").LiveThread(
        *(source, settings.stillness, run.stop, is_blocking),
        *(live.taught_of(settings), settings.set_use.lower()),
        *(live.lens_of(context, person), person, live_looks.keeper_of(settings)),
    )
    thread.set_frozen(live.frozen(settings))  # before the first picture
    run.thread = thread.thread
    if settings.driven == "CONTROLS":
        shown = scene_in.active(context)
        puppet = scene_out.live_controls.ControlPuppet(context.scene, shown)
        if shown.type == "ARMATURE":
            shown = scene_out.face_bones.deformed_face(context.scene, shown)
    else:
        shown = scene_in.face_of(context)
        puppet = scene_out.live.Puppet(context.scene, shown)
    fast = fast_view.FastView(shown) if settings.use_fast_view else None
    return live.Session(
        *(run, thread, puppet, fast),
        start=context.scene.frame_current_final,
        is_whole=is_blocking,
        shown=live.shown(context),
    )


def _finished(operator, context, session, message: str):
    for note in dict.fromkeys(session.notes):
        operator.report({"INFO"}, note)
    facts = {"object": session.puppet.name, "takes": session.takes}
    return outcome.finished(operator, context, message, **facts)


def _hints(session, settings) -> str:
    record = iface_("R ends the take") if session.is_recording else iface_("R records")
    keep = iface_("K keeps the look, ") if settings.use_teaching else ""
    text = iface_("N sets neutral, {record}, {keep}1 to {last} freeze channels, Esc stops").format(
        record=record, keep=keep, last=len(DIGITS)
    )
    names = [iface_(name).lower() for key, name, _ in CHANNELS if key not in settings.channels]
    frozen = iface_("   |   frozen: {names}").format(names=", ".join(names)) if names else ""
    return f"{text}{frozen}"


CLASSES = (MIMETIC_OT_live, MIMETIC_OT_live_command)
