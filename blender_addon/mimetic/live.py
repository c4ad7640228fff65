# SPDX-License-Identifier: GPL-3.0-or-later
"""The live session at work: what its operator drives and its panel shows."""

from __future__ import annotations

import os
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from . import clip_lens, clips, compat, fast_view, jobs, native, outcome, scene_in, takes, targets
from .live_settings import CHANNELS, package_channels
from .scene_out import face_fit
from .scene_out.live import Place

NO_SOURCE = "Choose a clip, or load the scene's footage"
ALL = frozenset(identifier for identifier, _, _ in CHANNELS)


@dataclass
class Session:
    """One session; the thread knows no Blender, all here runs on the main thread."""

    run: jobs.Run
    thread: object  # mimetic.puppet.live_thread.LiveThread
    puppet: object  # scene_out.live.Puppet, or scene_out.live_controls.ControlPuppet
    fast: fast_view.FastView | None = None
    view: object = None  # overlay.session.SessionView, where there is a window
    start: float = 1.0  # scene frame of the take that is recorded
    is_whole: bool = False  # `start` is then that of the clip's first picture, not the take's
    shown: Place | None = None  # where the scene shows the source, if that is the scene's clip
    sound: Path | None = None  # of that take's microphone
    due: float | None = None  # when a take begins that is counted down, by `monotonic`'s clock
    takes: list[str] = field(default_factory=list)  # recorded ones
    notes: list[str] = field(default_factory=list)
    commands: list[str] = field(default_factory=list)  # of buttons: NEUTRAL, RECORD, STOP

    def new_lines(self) -> list[str]:
        """What the session has told since the last time."""
        told = self.thread.told
        return [told.pop(0) for _ in range(len(told))]

    @property
    def is_recording(self) -> bool:
        return self.thread.is_recording

    def seconds_left(self) -> int | None:
        """Of the countdown."""
        return None if self.due is None else max(1, round(self.due - time.monotonic() + 0.5))

    def end(self) -> None:
        """Leaves nothing behind but what was recorded, however the session ended."""
        with ExitStack() as ends:
            ends.callback(self.puppet.end)
            if self.fast is not None:
                ends.callback(self.fast.end)
            if self.view is not None:
                ends.callback(self.view.close)

    def line(self) -> str:
        """For the user: what goes on."""
        state = iface_("recording") if self.is_recording else iface_("live")
        if left := self.seconds_left():
            state = iface_("recording in {seconds}").format(seconds=left)
        return f"{state}, {self.thread.line}"


active: Session | None = None


def no_live(context) -> str:
    """Why no session can be started."""
    if context.scene.mimetic.live.driven == "CONTROLS":
        return targets.no_controls(context)
    return targets.no_rest(context)


def source_of(context, is_paced: bool = True):
    """The source that the settings name; raises what `known_errors` has."""
    settings = context.scene.mimetic.live
    if settings.source == "CAMERA":
        return native.live_source(True).CameraSource(settings.camera)
    path = bpy.path.abspath(settings.clip_path) if settings.clip_path else ""
    clip = scene_in.clip_of(context)
    if not path and clip is not None:
        path = clips.source_of(clip, context.scene)
    if not path:
        raise native.invalid_input(NO_SOURCE)
    return native.live_source(False).ClipSource(path, is_paced)


def own_clip(context):
    """The scene's clip, where that is the source, or None."""
    settings = context.scene.mimetic.live
    if settings.source != "CLIP" or settings.clip_path:
        return None
    return scene_in.clip_of(context)


def shown(context) -> Place | None:
    """Where the scene shows the source, or None where it is not the scene's clip."""
    clip = own_clip(context)
    return None if clip is None else Place(clip.frame_start, clip.frame_offset)


def clip_with_fit(context):
    """The scene's clip, where a session may take the face that was found in it, or None.

    Another video may show another person; in front of a camera is mostly the one who was filmed.
    """
    settings = context.scene.mimetic.live
    if settings.fit_path or (settings.source == "CLIP" and settings.clip_path):
        return None
    return scene_in.clip_of(context)


def person_of(context):
    """The FaceFit of the person who is expected, or None; raises what `known_errors` has."""
    settings = context.scene.mimetic.live
    if not settings.use_fit:
        return None
    if settings.fit_path:
        return native.fitting().FaceFit.load(bpy.path.abspath(settings.fit_path))
    clip = clip_with_fit(context)
    return face_fit.of_clip(clip) if clip is not None else None


def lens_of(context, person):
    """The lens of the scene's footage, where that is the source, or None; raises what
    `known_errors` has. person: as `person_of` has it."""
    clip = own_clip(context)
    if clip is None:
        return None
    if person is not None and not context.scene.mimetic.live.fit_path:
        return native.puppet("live_heads").lens_of_fit(person)
    return clip_lens.known(clip)


def taught_of(settings):
    """The taught set that drives or sharpens, or None; raises what `known_errors` has."""
    if not settings.taught_set or settings.use_teaching:
        return None
    return native.puppet("templates").TaughtSet.load(bpy.path.abspath(settings.taught_set))


def frozen(settings) -> frozenset[str]:
    return package_channels(ALL - set(settings.channels))


def begin_take(context, session: Session) -> None:
    """From the scene's present frame on."""
    session.due = None
    session.start = context.scene.frame_current_final
    microphone = context.scene.mimetic.live.microphone
    session.sound = None
    if microphone and context.scene.mimetic.live.source == "CAMERA":
        session.sound = Path(_new_take(session).path()).with_suffix(".wav")
    session.thread.begin_take(microphone if session.sound else "", session.sound)


def end_take(context, session: Session) -> str:
    """Saves and keys what was recorded; returns a line for the user, "" if nothing was.

    Raises what `known_errors` has; what cannot be keyed is saved all the same.
    """
    take, offset = session.thread.end_take()
    if take is None:
        return ""
    performance = _performance_of(session, take)
    path, notes = takes.save(performance, _new_take(session))  # keying must not lose it
    session.takes.append(path)
    channels = package_channels(context.scene.mimetic.live.channels)
    name, place = takes.take_name(path), _place_of(session, performance)
    try:
        summary = session.puppet.record(context.scene, performance, name, place, channels)
    except native.known_errors() as error:
        raise native.invalid_input(
            rpt_("{path} is kept, but not keyed: {error}").format(path=path, error=error)
        ) from error
    session.notes += [*summary.remarks, *notes]
    _lay_sound(context.scene, session, take, path, offset, summary.first)
    return rpt_("{num_curves} curves from frame {first:.6g} to {last:.6g} on {name}").format(
        num_curves=summary.num_curves,
        first=summary.first,
        last=summary.last,
        name=session.puppet.name,
    )


def keep_unfinished(session: Session) -> None:
    """Saves the take that is still recorded, of a session that ends otherwise than by Stop: Blender
    is closed or opens a file, or an error has ended it. It is not keyed; the console names it."""
    if not session.is_recording:
        return
    session.thread.stop()
    take, _ = session.thread.end_take()
    if take is None:
        return
    try:
        path, _ = takes.save(_performance_of(session, take), _new_take(session))
    except native.known_errors() as error:
        print(outcome.readable(f"Mimetic: the take that was recorded is lost: {error}"))
    else:
        session.takes.append(path)
        print(outcome.readable(f"Mimetic: the take that was recorded is kept: {path}"))


def _performance_of(session: Session, take):
    """The Performance of a take; a camera has no footage."""
    return take.performance(getattr(session.thread.source, "footage", None))


def _place_of(session: Session, performance) -> Place:
    """Where a take lies: where the scene shows it, else from the scene's frame on."""
    if session.shown is not None:
        return session.shown
    return Place(session.start, 0 if session.is_whole else int(performance.frame[0]) - 1)


def _lay_sound(scene, session: Session, take, path: str, offset, first: float) -> None:
    """offset: of a microphone's, or None, as `end_take` of the thread has it; first: the scene
    frame of the take's first picture."""
    sound = session.sound
    if offset is None:
        sound, offset = Path(path).with_suffix(".wav"), 0.0
        if not session.thread.keep_clip_sound(take, sound):
            return
    rate = scene_in.timing(scene, None).scene_rate
    try:
        compat.add_sound(scene, sound.stem, str(sound), first + offset * rate)
    except RuntimeError as error:  # a Blender without sound; the take must not be lost for it
        session.notes.append(
            rpt_("{sound} is kept, but not laid in the sequencer: {error}")
            .format(sound=sound, error=error)
            .strip()
        )


def _new_take(session: Session) -> takes.NewTake:
    name = session.thread.source.name.replace(":", " ").replace(os.sep, " ")
    return takes.new_take(f"live {Path(name).stem}")
