# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks that the user drags: each becomes a pin, and the fit follows while the mouse moves.

The clip's markers are looked at by a timer, as no event comes while a marker is dragged.
All lasting state is in the .blend, so undo needs no code: markers and fit go back together.
"""

from __future__ import annotations

import time

import bpy

from . import editors, jobs, native, scene_in
from .scene_out import face_fit, landmarks

WATCH_SECONDS, FOLLOW_SECONDS = 0.15, 0.02

_states: dict[str, bytes] = {}  # clip: its markers when they were last looked at
last_ms = 0.0  # what the last following took


def follow(clip: bpy.types.MovieClip) -> list[str]:
    """Pins the landmarks that were moved and fits again; returns their names.

    Raises InvalidInput, and changes nothing then.
    """
    fit = face_fit.of_clip(clip)
    moves = landmarks.find_moves(clip, fit) if fit else {}
    for frame, places in moves.items():
        fit = native.fitting().refit(fit, fit.pins.get(frame, {}) | places, frame)
    if moves:
        face_fit.update(clip, fit)
    return sorted({name for places in moves.values() for name in places})


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
        _states.clear()
        return WATCH_SECONDS
    clips = _shown_clips(scene)
    for name in _states.keys() - {clip.name for clip in clips}:
        del _states[name]
    # All of them, whatever comes of the first
    return FOLLOW_SECONDS if any([_watch(clip) for clip in clips]) else WATCH_SECONDS


def _shown_clips(scene) -> list[bpy.types.MovieClip]:
    """The scene's clip and those in clip editors, if their landmarks are those of their faces."""
    clips = [scene.mimetic.clip]
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "CLIP_EDITOR":
                clips.append(area.spaces.active.clip)
    return [clip for clip in dict.fromkeys(clips) if clip and scene_in.shows_landmarks(clip)]


def _watch(clip) -> bool:
    """Follows a clip's landmarks; says whether they may move again at once."""
    global last_ms
    now = landmarks.state(clip)
    if now == _states.get(clip.name):
        return _is_dragging()
    start = time.perf_counter()
    try:
        names = follow(clip)
    except native.known_errors() as error:
        print(f"Mimetic: the pins cannot be followed: {error}")
        names = []
    if names:
        last_ms = 1000 * (time.perf_counter() - start)
        editors.redraw("CLIP_EDITOR")
    _states[clip.name] = landmarks.state(clip)
    return True


def _is_dragging() -> bool:
    window = bpy.context.window_manager.windows[0] if bpy.context.window_manager.windows else None
    return bool(window and len(window.modal_operators))


def register() -> None:
    bpy.app.timers.register(watch, first_interval=WATCH_SECONDS, persistent=True)


def unregister() -> None:
    _states.clear()
    if bpy.app.timers.is_registered(watch):
        bpy.app.timers.unregister(watch)
