# SPDX-License-Identifier: GPL-3.0-or-later
"""Captured takes: performance files, which belong to a clip or to none. (What a bake makes of one
is a baked take: `take_rows`.)

The .blend names a take's file relative to itself, so that both may move together, also when it is
saved elsewhere. A file that is not where it was is looked for beside the .blend.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.app.handlers import persistent
from bpy.app.translations import pgettext_rpt as rpt_

from . import clips, handlers, native


@dataclass(frozen=True)
class Take:
    """The captured take that buttons act on, for a worker: no reference to Blender's data."""

    path: str  # of a file that is there
    clip_name: str = ""  # of the clip that it belongs to
    fingerprint: str = ""  # of that clip's content


def save(performance, path: str, spare_path: str) -> tuple[str, list[str]]:
    """Writes a performance; returns where it is, and what the user should know."""
    notes = performance.notes or []
    try:
        performance.save(path)
    except OSError as error:  # minutes of work: not lost for a folder that is read-only
        performance.save(spare_path)
        message = rpt_("{path} cannot be written ({reason}): saved as {spare}").format(
            path=path, reason=error.strerror, spare=spare_path
        )
        return spare_path, [message, *notes]
    return path, [*notes]


def new_paths(clip_name: str, path: str = "") -> tuple[str, str]:
    """Where a new take of a clip goes, and where if it cannot be written there: for `save`.

    path: as the user gave it; "" for one beside the .blend, or with the user's files if there is
    no .blend yet.
    """
    spare = _spare_path(clip_name)
    if path:
        return bpy.path.abspath(path), spare
    if not bpy.data.filepath:
        return spare, spare
    return _new_take(Path(bpy.path.abspath("//")), clip_name), spare


def new_set_path() -> str:
    """Where a new taught set goes: beside the .blend, or with the user's files."""
    folder = Path(bpy.path.abspath("//")) if bpy.data.filepath else _user_folder()
    return _new_file(folder, "looks", "taught")


def _user_folder() -> Path:
    return Path(bpy.utils.extension_path_user(__package__, path="captures", create=True))


def _spare_path(clip_name: str) -> str:
    return _new_take(_user_folder(), clip_name)


def _new_take(folder: Path, clip_name: str) -> str:
    return _new_file(folder, Path(clip_name).stem, "performance")


def _new_file(folder: Path, name: str, kind: str) -> str:
    stem = bpy.path.clean_name(name)
    path = folder / f"{stem}.{kind}.npz"
    number = 1
    while path.exists():  # none overwrites the one before
        number += 1
        path = folder / f"{stem}.{number:03d}.{kind}.npz"
    return str(path)


def load(take: Take):
    """The take's Performance; raises what it raises, and InvalidInput if it is another clip's."""
    performance = native.performances().Performance.load(take.path)
    if not performance.is_of(take.fingerprint):
        raise native.invalid_input(
            rpt_(
                "{file} was captured from {footage}, which is not what {clip} "
                "shows: press Capture, or Load Performance for its own"
            ).format(file=Path(take.path).name, footage=performance.footage[0], clip=take.clip_name)
        )
    return performance


def load_edited(path: str, curves: dict | None):
    """A Performance with its curves edited by the fields of a CurveSettings, if there are any."""
    performance = native.performances().Performance.load(path)
    parts = native.curve_settings()
    return parts.edited(performance, parts.CurveSettings(**(curves or {})))


def action_name(take: Take, performance) -> str:
    """What a bake's actions are called after: the clip, else the footage, else the file."""
    footage = performance.footage[0] if performance.footage else ""
    return take_name(take.clip_name or footage or take.path)


def take_name(path: str | os.PathLike[str]) -> str:
    """What a take from this clip or performance is called; Blender's names are Unicode, always."""
    return native.shown_text().shown(Path(path).name.split(".")[0])


def keep(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None, path: str):
    """Makes a file the take that is used, of a clip, or of the scene while it has no clip; returns
    what holds its path. `captured_takes.keep` lists it, too."""
    holder = scene.mimetic if clip is None else clips.ensure(clip)
    holder.performance_path = _relative(os.path.abspath(path), bpy.data.filepath)
    return holder


def of_clip(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None):
    """What holds the take's path: of the clip, or of the scene while it has no clip; or None."""
    holder = scene.mimetic if clip is None else clips.find(clip)
    return holder if holder is not None and holder.performance_path else None


def name_of(holder) -> str:
    return Path(holder.performance_path.replace("\\", "/").removeprefix("//")).name


def find(holder) -> str:
    """Where the file is that a holder names, there or beside the .blend; "" if it is missing."""
    path = path_of(holder)
    beside = bpy.path.abspath(f"//{name_of(holder)}") if bpy.data.filepath else ""
    return next((place for place in (path, beside) if place and os.path.isfile(place)), "")


def named(name: str) -> Take | None:
    """The captured take in a file of this name: one that the .blend uses or lists, else one
    beside it or beside those; None if there is none."""
    holders = [holder for holder in _holders() if holder.performance_path]
    found = next((h for h in holders if name_of(h) == name and find(h)), None)
    if found is None:
        own = [bpy.path.abspath("//")] if bpy.data.filepath else []
        folders = [*own, *(os.path.dirname(path_of(holder)) for holder in holders)]
        beside = (os.path.join(folder, name) for folder in folders)
        path = next(filter(os.path.isfile, beside), "")
        return Take(path) if path else None
    if isinstance(found.id_data, bpy.types.Scene):
        return Take(find(found))
    return Take(find(found), found.id_data.name, _footage_of(found))


def missing() -> list:
    """Everything in the .blend that names a take whose file is missing."""
    return [h for h in _holders() if h.performance_path and not find(h)]


def place(holder, path: str) -> bool:
    """Sets where a take is now, if it is of the holder's footage; returns whether it is."""
    try:
        load(Take(path, holder.id_data.name, _footage_of(holder)))
    except native.known_errors():
        return False
    holder.performance_path = _relative(path, bpy.data.filepath)
    return True


def _holders() -> list:
    """Everything in the .blend itself that may name a take: what is used, and the lists' rows."""
    holders = [scene.mimetic for scene in bpy.data.scenes if not scene.library]
    for clip in bpy.data.movieclips:
        if not clip.library:
            holders += clip.mimetic.footage
            holders += [row for record in clip.mimetic.footage for row in record.captured]
    return holders


def _footage_of(holder) -> str:
    """The fingerprint of the footage that a holder's take is of, "" where that is not known."""
    if isinstance(holder.id_data, bpy.types.Scene):
        return ""
    records = holder.id_data.mimetic.footage
    return next(r.name for r in records if holder == r or holder in list(r.captured))


def path_of(holder) -> str:
    """Where the file that a holder names should be."""
    path = bpy.path.abspath(holder.performance_path, library=holder.id_data.library)
    return os.path.normpath(path)


def _relative(path: str, blend: str) -> str:
    """As a .blend names a file."""
    own = os.path.abspath(bpy.utils.extension_path_user(__package__))
    # The extension's own folder stays where it is, whatever way the .blend goes
    if not blend or os.path.abspath(path).startswith(own + os.sep):
        return path
    try:
        return bpy.path.relpath(path, start=os.path.dirname(blend))
    except ValueError:  # on another of Windows' drives
        return path


_references: list[tuple] = []  # while the .blend is saved: what named a take, and its file


@persistent
def name_from_new_place(blend: str, *_) -> None:
    """Before saving: takes are named as seen from where the .blend will be."""
    for clip in bpy.data.movieclips:
        clips.settle(clip)
    _references[:] = [(h, find(h) or path_of(h)) for h in _holders() if h.performance_path]
    _name(blend)


@persistent
def name_from_own_place(*_) -> None:
    """After saving a copy, or after saving failed: the open .blend is where it was."""
    _name(bpy.data.filepath)
    _references.clear()


def _name(blend: str) -> None:
    for holder, path in _references:
        name = _relative(path, blend)
        if holder.performance_path != name:
            holder.performance_path = name


@persistent
def open_file(*_) -> None:
    clips.migrate()


HANDLERS = (
    (bpy.app.handlers.save_pre, name_from_new_place),
    (bpy.app.handlers.save_post, name_from_own_place),
    (bpy.app.handlers.save_post_fail, name_from_own_place),
    (bpy.app.handlers.load_post, open_file),
)


def register() -> None:
    handlers.add(HANDLERS)
    # A file that was open before the extension was; none may be touched while it registers
    bpy.app.timers.register(open_file, first_interval=0.0)


def unregister() -> None:
    if bpy.app.timers.is_registered(open_file):
        bpy.app.timers.unregister(open_file)
    handlers.remove(HANDLERS)
