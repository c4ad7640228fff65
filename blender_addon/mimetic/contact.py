# SPDX-License-Identifier: GPL-3.0-or-later
"""Lips and lids of faces kept apart while their sliders move: follows what Blender evaluates.

What is needed to know a face is made once a session, in a thread where there is a window.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field

import bpy
import numpy as np
from bpy.app.handlers import persistent

from . import handlers, heads, native, scene_in
from .scene_out import contact as contact_key
from .scene_out import sliders

POLL_SECONDS = 0.1


@dataclass
class Known:
    """One face; `problem` says why its contact is not known."""

    rest: np.ndarray  # V x 3 float32, object frame
    attachment: tuple  # heads.attachment
    make: Callable  # without Blender
    live: object = None  # mimetic.live_contact.LiveContact
    problem: str = ""
    error: BaseException | None = None
    thread: threading.Thread | None = None
    values: dict[str, float] | None = None  # that the key was made for
    is_parted: bool = True  # whether the key may hold anything: it does in an opened file
    weights: sliders.Weights = field(default_factory=dict)  # painted in modes without contact

    def start(self) -> None:
        # A daemon: Blender must be able to quit meanwhile
        self.thread = threading.Thread(target=self._make, name="contact", daemon=True)
        self.thread.start()

    def look_again(self) -> None:
        self.values, self.is_parted = None, True
        self.weights.clear()

    def is_of(self, rest: np.ndarray, attachment: tuple) -> bool:
        return self.attachment == attachment and np.array_equal(self.rest, rest)

    def _make(self) -> None:
        try:
            self.live = self.make()
        except native.known_errors() as error:
            self.problem = str(error)
        except BaseException as error:  # raised where Blender shows it
            self.error = error

    def is_ready(self, wait: bool) -> bool:
        if wait:
            self.thread.join()
        if self.error:
            error, self.error = self.error, None
            self.problem = f"{type(error).__name__}: {error}"
            raise error
        return not self.thread.is_alive() and self.live is not None


_states: dict[str, Known] = {}


def problem_of(face: bpy.types.Object) -> str:
    """Why the lips of a face are not kept apart, or the empty string."""
    return _states[face.name].problem if face.name in _states else ""


@persistent
def forget_all(*_) -> None:
    """Another file is open: the states are of faces that no longer exist."""
    _states.clear()
    contact_key.still_faces.clear()
    contact_key.resting_faces.clear()


@persistent
def look_again(*_) -> None:
    """After undo, which may have restored any value and any key: read all again."""
    for state in _states.values():
        state.look_again()


@persistent
def follow(scene, depsgraph) -> None:
    """Parts the lips and lids of the scene's faces, as far as their sliders moved."""
    for face in scene.objects:
        if not scene_in.is_face(face) or face.library:
            continue
        if _is_followed(face):
            _follow_face(scene, face, depsgraph)
        elif face.name in _states:  # switched off, or its shapes are being sculpted
            _states[face.name].look_again()


def _is_followed(face: bpy.types.Object) -> bool:
    return (
        face.mimetic.use_contact
        and contact_key.key_of(face) is not None
        and face.mode == "OBJECT"
        and face.name not in contact_key.still_faces
    )


def _follow_face(scene, face: bpy.types.Object, depsgraph) -> None:
    if native.problem():
        return
    keys = face.data.shape_keys
    # Curves and drivers show in the evaluated keys only, where a picture is rendered
    evaluated_keys = keys.evaluated_get(depsgraph)
    values = sliders.levels_of(evaluated_keys)
    values.pop(contact_key.KEY, None)
    state = _states.get(face.name)
    if state is None and not values:
        return
    rest = contact_key.points_of(keys.reference_key)
    attachment = heads.attachment(face)
    if state is None or not state.is_of(rest, attachment):
        state = _states[face.name] = Known(rest, attachment, _maker(scene, face, rest))
        state.start()
    if face.name in contact_key.resting_faces:
        state.look_again()
    if values == state.values:
        return
    if not state.is_ready(_waits(depsgraph)):
        if not state.problem and not bpy.app.timers.is_registered(_poll):
            bpy.app.timers.register(_poll, first_interval=POLL_SECONDS)
        return
    state.values = values
    contact_key.resting_faces.discard(face.name)
    correction = state.live.correction(sliders.moves(face, values, rest, state.weights))
    if correction is not None or state.is_parted:
        sliders.take_levels(keys, evaluated_keys)
        contact_key.place(face, state.live.moved, correction)
    state.is_parted = correction is not None


def _waits(depsgraph) -> bool:
    """Whether contact is computed at once: in background mode, or while rendering."""
    return bpy.app.background or depsgraph.mode == "RENDER"


def _maker(scene, face: bpy.types.Object, rest: np.ndarray) -> Callable:
    """Makes the mimetic.live_contact.LiveContact of a face, of our own mesh or another's."""
    head = heads.remembered_head(scene, face)
    if head is None:
        return lambda: native.live_contact().live_contact(rest)
    parts = native.foreign_face()
    num_vertices = len(head.points)

    def make():
        face = parts.attach_face(*head.whole, head.landmarks, head.matrix)
        return face.live_contact.of_first(num_vertices)

    return make


def _poll() -> float | None:
    """Makes Blender evaluate faces again once their contact is known."""
    if any(state.thread.is_alive() for state in _states.values()):
        return POLL_SECONDS
    for name in _states:
        face = bpy.data.objects.get(name)
        if face is not None and scene_in.is_face(face):  # another object may have its name by now
            face.data.shape_keys.update_tag()
    return None


HANDLERS = (
    (bpy.app.handlers.load_post, forget_all),
    (bpy.app.handlers.undo_post, look_again),
    (bpy.app.handlers.redo_post, look_again),
    (bpy.app.handlers.depsgraph_update_post, follow),
    (bpy.app.handlers.frame_change_post, follow),
)


def register() -> None:
    handlers.add(HANDLERS)


def unregister() -> None:
    handlers.remove(HANDLERS)
    if bpy.app.timers.is_registered(_poll):
        bpy.app.timers.unregister(_poll)
    _states.clear()
