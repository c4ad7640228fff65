# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks that the user drags: each becomes a pin, and the fit follows while the mouse moves.

The clip's markers are looked at by a timer, as no event comes while a marker is dragged.
All lasting state is in the .blend, so undo needs no code: markers and fit go back together.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field

import bpy
import numpy as np

from . import clips, editors, jobs, native, scene_in
from .scene_out import face_fit, landmarks

WATCH_SECONDS, FOLLOW_SECONDS = 0.15, 0.02
DRAGS = ("CLIP_OT_slide_marker", "TRANSFORM_OT_")  # Blender's operators that move markers
SAME_PLACE = 1e-6  # of the picture's width: Blender's own cancelling may round


@dataclass
class Drag:
    """A clip when one of `DRAGS` began, which may be cancelled."""

    markers: bytes  # their state
    fit: str  # JSON
    # Landmarks that were followed meanwhile, each in a frame of the footage
    moved: set[tuple[str, int]] = field(default_factory=set)


_states: dict[str, bytes] = {}  # clip: its markers when they were last looked at
_drags: dict[str, Drag] = {}  # clip: the drag that goes on
last_ms = 0.0  # what the last following took


def follow(clip: bpy.types.MovieClip) -> list[str]:
    """Pins the landmarks that were moved and fits again; returns their names.

    Raises InvalidInput, and changes nothing then.
    """
    return sorted({name for name, _ in _follow(clip)})


def _follow(clip) -> set[tuple[str, int]]:
    """The same; returns the landmarks with the frame of the footage in which each was moved."""
    fit = face_fit.of_clip(clip)
    moves = landmarks.find_moves(clip, fit) if fit else {}
    for frame, places in moves.items():
        fit = native.fitting().refit(fit, fit.pins.get(frame, {}) | places, frame)
    if moves:
        face_fit.update(clip, fit)
    return {(name, frame) for frame, places in moves.items() for name in places}


def pin(clip, names: list[str], frame: int) -> None:
    """Pins landmarks where they are in a frame of the footage."""
    fit = face_fit.of_clip(clip)
    places = landmarks.expected_places(fit, frame)
    pins = fit.pins.get(frame, {}) | {name: places[name] for name in names if name in places}
    face_fit.update(clip, native.fitting().refit(fit, pins, frame))


def unpin(clip, names: list[str]) -> None:
    """Lets go of landmarks in all frames."""
    fit = face_fit.of_clip(clip)
    for frame, pins in fit.pins.items():
        others = {name: place for name, place in pins.items() if name not in names}
        if others != pins:
            fit = native.fitting().refit(fit, others, frame)
    face_fit.update(clip, fit)


def watch() -> float:
    """The timer's callback: returns the seconds until its next call."""
    scene = bpy.context.scene
    if not scene or not scene.mimetic.use_live_pins or jobs.running or native.problem():
        _forget()
        return WATCH_SECONDS
    shown = _shown_clips(scene)
    for known in (_states, _drags):
        for name in known.keys() - {clip.name for clip in shown}:
            del known[name]
    # All of them, whatever comes of the first
    return FOLLOW_SECONDS if any([_watch(clip) for clip in shown]) else WATCH_SECONDS


def _shown_clips(scene) -> list[bpy.types.MovieClip]:
    """The scene's clip and those in clip editors, if their landmarks are those of their faces."""
    shown = [scene.mimetic.clip]
    shown += [area.spaces.active.clip for area in editors.open_editors("CLIP_EDITOR")]
    return [clip for clip in dict.fromkeys(shown) if clip and scene_in.shows_landmarks(clip)]


def _watch(clip) -> bool:
    """Follows a clip's landmarks; says whether they may move again at once."""
    global last_ms
    if _is_dragging():
        if clip.name not in _drags:  # they may have moved since they were last looked at
            markers = _states.get(clip.name) or landmarks.state(clip)
            _drags[clip.name] = Drag(markers, face_fit.content(clip))
    elif (drag := _drags.pop(clip.name, None)) and _is_taken_back(clip, drag):
        clips.ensure(clip).face_fit = drag.fit
        landmarks.place(clip, face_fit.of_clip(clip))
        _states[clip.name] = landmarks.state(clip)
        editors.redraw("CLIP_EDITOR")
        return False
    now = landmarks.state(clip)
    if now == _states.get(clip.name):
        return _is_busy()
    start = time.perf_counter()
    try:
        moved = _follow(clip)
    except native.known_errors() as error:
        print(f"Mimetic: the pins cannot be followed: {error}")
        moved = set()
    if moved:
        last_ms = 1000 * (time.perf_counter() - start)
        editors.redraw("CLIP_EDITOR")
        if clip.name in _drags:
            _drags[clip.name].moved.update(moved)
    _states[clip.name] = landmarks.state(clip)
    return True


def _is_taken_back(clip, drag: Drag) -> bool:
    """Whether Blender has all that was dragged where it was before: Esc, or a right click. Others
    were moved by the fit alone, which no cancelling takes back."""
    marked = [
        (track.name, marker.frame + clip.frame_offset) in drag.moved
        for track in landmarks.tracks_of(clip)
        for marker in track.markers
        if not marker.mute
    ]
    states = drag.markers, landmarks.state(clip)
    before, now = (np.frombuffer(state, np.float32).reshape(-1, 2) for state in states)
    if not drag.moved or len(before) != len(now) or len(now) != len(marked):
        return False
    return bool((np.abs(now - before)[marked] <= SAME_PLACE).all())


def _is_dragging() -> bool:
    """Whether something that may be markers goes with the mouse in any window."""
    return any(name.startswith(DRAGS) for name in _at_work())


def _is_busy() -> bool:
    return any(_at_work())


def _at_work() -> list[str]:
    windows = bpy.context.window_manager.windows
    return [operator.bl_idname for window in windows for operator in window.modal_operators]


def _forget() -> None:
    _states.clear()
    _drags.clear()


def register() -> None:
    bpy.app.timers.register(watch, first_interval=WATCH_SECONDS, persistent=True)


def unregister() -> None:
    _forget()
    if bpy.app.timers.is_registered(watch):
        bpy.app.timers.unregister(watch)
