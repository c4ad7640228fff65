# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks that are dragged on a head with muscles: once they keep still, *Attach Muscles* runs.
A *Preview* of the head, which that ends, begins again.

Places are compared only after Blender has evaluated an empty. What an undo or a redo puts somewhere
else is taken as it is: it brings the muscles that belong there, and no step of its own may follow.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass

import bpy
from bpy.app.handlers import persistent
from bpy.app.translations import pgettext_iface as iface_

from . import control_preview, editors, handlers, heads, jobs, native, outcome, playback, scene_in
from .job_run import Run

WATCH_SECONDS, STILL_SECONDS = 0.1, 0.5

Places = dict[str, tuple[float, float, float]]  # of landmarks, in their parents


@dataclass
class Watched:
    """A head's landmarks as they were last looked at."""

    places: Places
    moved: float | None = None  # when, of a drag that is not followed yet


@dataclass(frozen=True)
class Following:
    """The job that follows a drag."""

    head: str
    places: Places  # that it has read
    run: Run
    previewed: str = ""  # the character whose preview it ends


_watched: dict[str, Watched] = {}
_following: Following | None = None
_is_stale = True  # landmarks may be elsewhere than they were last seen


def watch() -> float:
    """The timer's callback: returns the seconds until its next call."""
    if not native.problem():
        _show_again()
        now = time.monotonic()
        if _is_stale and (_following or not editors.is_dragging()):
            look(now)
        if due := next_due(now):
            _attach(*due)
    return WATCH_SECONDS


def look(now: float) -> None:
    """Notes which landmarks are elsewhere than when they were last looked at. now: seconds."""
    global _is_stale
    _is_stale = False
    found = {head.name: (scene, head) for _, scene, head in _shown_heads()}
    for name in _watched.keys() - found.keys():
        del _watched[name]
    for name, (scene, head) in found.items():
        places, before = _places(scene, head), _watched.get(name)
        if before is None:
            _watched[name] = Watched(places)
            continue
        common = places.keys() & before.places.keys()
        if any(places[mark] != before.places[mark] for mark in common):
            before.moved = now if head.mimetic.use_live_landmarks else None
        before.places = places
    _drop_outdated()


def next_due(now: float) -> tuple[bpy.types.Window, bpy.types.Object] | None:
    """A head whose landmarks were dragged and are still since long enough, and its window.

    None while nothing may begin, too. now: seconds.
    """
    if not any(watched.moved is not None for watched in _watched.values()):
        return None
    if editors.is_dragging():
        for watched in _watched.values():
            watched.moved = watched.moved and now
        return None
    if jobs.running or playback.is_rendering() or bpy.app.is_job_running("OBJECT_BAKE"):
        return None
    for window, scene, head in _shown_heads():
        watched, active = _watched.get(head.name), window.view_layer.objects.active
        if watched is None or watched.moved is None or now - watched.moved < STILL_SECONDS:
            continue
        if (active and active.mode != "OBJECT") or head.mode != "OBJECT":
            continue
        watched.moved = None
        if head.mimetic.use_live_landmarks and heads.moved_landmarks(scene, head):
            return window, head
    return None


def _shown_heads() -> Iterator[tuple[bpy.types.Window, bpy.types.Scene, bpy.types.Object]]:
    """Heads with muscles in the scenes of all windows, each once."""
    seen = set()
    for window in bpy.context.window_manager.windows:
        scene = window.scene
        if scene.name not in seen:
            seen.add(scene.name)
            for obj in scene.objects:
                if obj.type == "MESH" and len(obj.mimetic.landmarks):
                    yield window, scene, obj


def _places(scene: bpy.types.Scene, head: bpy.types.Object) -> Places:
    """Of the landmarks that only a hand moves: one that is animated is elsewhere in each frame."""
    empties = heads.landmark_empties(scene, head)
    return {name: tuple(e.location) for name, e in empties.items() if e.animation_data is None}


def _attach(window: bpy.types.Window, head: bpy.types.Object) -> None:
    """As the button does, beside the window; says what hinders it as the button does."""
    global _following
    attach = bpy.ops.mimetic.attach_muscles
    with bpy.context.temp_override(window=window, active_object=head, object=head):
        reason = heads.no_foreign_head(bpy.context)
        try:
            if not reason:
                attach("INVOKE_DEFAULT", others=head.mimetic.others)
        except RuntimeError as error:  # reported, and by nobody shown
            reason = outcome.told_by(error)
        if reason:
            _tell(iface_(reason))
        elif jobs.running:
            shown = control_preview.active.name if control_preview.is_moving(head) else ""
            _following = Following(head.name, _watched[head.name].places, jobs.running, shown)


def _show_again() -> None:
    """Begins the preview again that following has ended."""
    global _following
    done = _following
    if done is None or done.run is jobs.running:
        return
    _following = None
    character = bpy.data.objects.get(done.previewed)
    if character is None or done.run.stop.is_set() or control_preview.active or jobs.running:
        return
    windows = bpy.context.window_manager.windows
    window = next((w for w in windows if scene_in.holds(w.view_layer, character)), None)
    if window is None:
        return
    with bpy.context.temp_override(window=window, active_object=character, object=character):
        try:
            bpy.ops.mimetic.preview_controls("INVOKE_DEFAULT")
        except RuntimeError as error:  # reported, and by nobody shown
            _tell(outcome.told_by(error))


def _tell(reason: str) -> None:
    def draw(menu, context) -> None:
        menu.layout.label(text=reason)

    title = iface_("Attach Muscles", "Operator")
    bpy.context.window_manager.popup_menu(draw, title=title, icon="ERROR")


def _drop_outdated() -> None:
    """Ends the job that follows a drag after another one, or an undo of it."""
    global _following
    if _following is None:
        return
    if _following.run is not jobs.running:
        _following = None
        return
    watched = _watched.get(_following.head)
    if watched is None or watched.places != _following.places:
        _following.run.stop.set()


@persistent
def note(scene, depsgraph=None) -> None:
    """After Blender evaluated the scene."""
    global _is_stale
    if _is_stale or depsgraph is None:
        return
    for update in depsgraph.updates:
        if isinstance(update.id, bpy.types.Object) and _may_concern(update.id):
            _is_stale = True
            return


def _may_concern(obj: bpy.types.Object) -> bool:
    """Whether an object may be a watched head's landmark, or a head that is not watched yet."""
    if obj.type == "EMPTY" and _watched:
        return bool(obj.mimetic.landmark) or obj.parent is None
    return obj.type == "MESH" and obj.name not in _watched and len(obj.mimetic.landmarks) > 0


@persistent
def take_as_is(*_) -> None:
    """After an undo or a redo, or as a file is opened."""
    global _is_stale
    _watched.clear()
    if native.problem():
        _is_stale = True
    else:
        look(time.monotonic())


HANDLERS = (
    (bpy.app.handlers.load_post, take_as_is),
    (bpy.app.handlers.undo_post, take_as_is),
    (bpy.app.handlers.redo_post, take_as_is),
    (bpy.app.handlers.depsgraph_update_post, note),
)


def register() -> None:
    if bpy.app.background:  # nobody drags there
        return
    handlers.add(HANDLERS)
    bpy.app.timers.register(watch, first_interval=WATCH_SECONDS, persistent=True)


def unregister() -> None:
    global _following, _is_stale
    _following, _is_stale = None, True
    _watched.clear()
    handlers.remove(HANDLERS)
    # After an error in it Blender calls a timer no more, nor knows it
    if bpy.app.timers.is_registered(watch):
        bpy.app.timers.unregister(watch)
