# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks that the user drags: each becomes a pin, and the fit follows while the mouse moves.

The clip's markers are looked at by a timer, since no event tells of a marker that is being dragged.
All that lasts is in the file, so that undo needs no care: markers and fit go back together.
"""

from __future__ import annotations

import time

import bpy

from . import jobs, native
from .scene_out import face_fit, landmarks

WATCH_SECONDS, FOLLOW_SECONDS = 0.15, 0.02

followed: tuple[str, bytes] | None = None  # clip, and its markers when they were last looked at
last_ms = 0.0  # what the last following took


def follow(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> list[str]:
    """Pins the landmarks that were moved and fits again; returns their names.

    Raises InvalidInput, and changes nothing then.
    """
    fit = face_fit.stored(scene)
    moved = landmarks.moved(clip, fit) if fit else {}
    for frame, places in moved.items():
        fit = native.part("fit").refit(fit, fit.pins.get(frame, {}) | places, frame)
    if moved:
        face_fit.update(scene, clip, fit)
    return sorted({name for places in moved.values() for name in places})


def pin(scene, clip, names: list[str], frame: int) -> None:
    """Pins landmarks where they are in a frame of the footage."""
    fit = face_fit.stored(scene)
    places = landmarks.expected(fit, frame)
    pins = fit.pins.get(frame, {}) | {name: places[name] for name in names if name in places}
    face_fit.update(scene, clip, native.part("fit").refit(fit, pins, frame))


def unpin(scene, clip, names: list[str]) -> None:
    """Lets go of landmarks in all frames."""
    fit = face_fit.stored(scene)
    for frame, pins in fit.pins.items():
        kept = {name: place for name, place in pins.items() if name not in names}
        if kept != pins:
            fit = native.part("fit").refit(fit, kept, frame)
    face_fit.update(scene, clip, fit)


def watch() -> float:
    """The timer: seconds until it wants to look again."""
    global followed, last_ms
    scene = bpy.context.scene
    clip = scene.mimetic.clip if scene else None
    if not clip or not scene.mimetic.face_fit or not scene.mimetic.use_live_pins or jobs.running:
        followed = None
        return WATCH_SECONDS
    now = (clip.name, landmarks.state(clip))
    if now == followed:
        return WATCH_SECONDS if not _is_dragging() else FOLLOW_SECONDS
    start = time.perf_counter()
    try:
        names = follow(scene, clip)
    except native.known_errors() as error:
        print(f"Mimetic: the pins cannot be followed: {error}")
        names = []
    if names:
        last_ms = 1000 * (time.perf_counter() - start)
        redraw()
    followed = (clip.name, landmarks.state(clip))
    return FOLLOW_SECONDS


def _is_dragging() -> bool:
    window = bpy.context.window_manager.windows[0] if bpy.context.window_manager.windows else None
    return bool(window and len(window.modal_operators))


def redraw() -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "CLIP_EDITOR":
                area.tag_redraw()


def register() -> None:
    bpy.app.timers.register(watch, first_interval=WATCH_SECONDS, persistent=True)


def unregister() -> None:
    global followed
    followed = None
    if bpy.app.timers.is_registered(watch):
        bpy.app.timers.unregister(watch)
