# SPDX-License-Identifier: GPL-3.0-or-later
"""Captured takes: performance files, which belong to a clip or to none. (What a bake makes of one
is a baked take: `take_rows`.)

The .blend names a take's file relative to itself, so that both may move together, also when it is
saved elsewhere. A file that is not where it was is looked for beside the .blend.
"""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from bpy.app.handlers import persistent
from bpy.app.translations import pgettext_rpt as rpt_

from . import clips, handlers, native

MEASURED = (
    "frame",
    "activations",
    "activations_std",
    "articulator_values",
    "articulator_values_std",
    "confounded_with",
    "quality",
)


@dataclass(frozen=True)
class Take:
    """The captured take that buttons act on, for a worker: no reference to Blender's data."""

    path: str  # of a file that is there
    clip_name: str = ""  # of the clip that it belongs to
    fingerprint: str = ""  # of that clip's content


@dataclass(frozen=True)
class NewTake:
    """Where a take that is being made will go, for a worker."""

    stem: str  # of a file's name
    folder: Path
    spare: Path  # folder, where the other cannot be written to
    given: str = ""  # file that the user named, which may be overwritten

    def path(self) -> str:
        """Of no file that is there now: others may have been written since this was made."""
        return self.given or _new_file(self.folder, self.stem, "performance")

    def spare_path(self) -> str:
        return _new_file(self.spare, self.stem, "performance")


def save(performance, new: NewTake) -> tuple[str, list[str]]:
    """Writes a performance; returns where it is, and what the user should know."""
    notes, path = performance.notes or [], new.path()
    try:
        performance.save(path)
    except OSError as error:  # minutes of work: not lost for a folder that is read-only
        spare = new.spare_path()
        performance.save(spare)
        message = rpt_("{path} cannot be written ({reason}): saved as {spare}").format(
            path=path, reason=error.strerror or error, spare=spare
        )
        return spare, [message, *notes]
    return path, [*notes]


def new_take(clip_name: str, path: str = "") -> NewTake:
    """Where a new take of a clip goes.

    path: as the user gave it; "" for one beside the .blend, or with the user's files if there is
    no .blend yet.
    """
    spare = _user_folder()
    folder = Path(bpy.path.abspath("//")) if bpy.data.filepath else spare
    stem = bpy.path.clean_name(Path(clip_name).stem)
    return NewTake(stem, folder, spare, bpy.path.abspath(path) if path else "")


def new_set_path() -> str:
    """Where a new taught set goes: beside the .blend, or with the user's files."""
    folder = Path(bpy.path.abspath("//")) if bpy.data.filepath else _user_folder()
    return _new_file(folder, "looks", "taught")


def _user_folder() -> Path:
    return Path(bpy.utils.extension_path_user(__package__, path="captures", create=True))


def _new_file(folder: Path, stem: str, kind: str) -> str:
    path = folder / f"{stem}.{kind}.npz"
    number = 1
    while path.exists():  # none overwrites the one before
        number += 1
        path = folder / f"{stem}.{number:03d}.{kind}.npz"
    return str(path)


def load(take: Take):
    """The take's Performance; raises what it raises, and InvalidInput if it is another clip's."""
    performance = _read(take.path)
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
    performance = _read(path)
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
    """Where the file is that a holder names, there or, if it is of the holder's footage, beside
    the .blend; "" if it is missing."""
    path = path_of(holder)
    if os.path.isfile(path) or not bpy.data.filepath:
        return path if os.path.isfile(path) else ""
    beside = bpy.path.abspath(f"//{name_of(holder)}")
    return beside if os.path.isfile(beside) and _is_of(beside, _footage_of(holder)) else ""


@dataclass(frozen=True)
class _Content:
    """What is remembered of a file that was read."""

    footage: str  # fingerprint of its footage, "" if it is not known
    capture: str  # `capture_of`


_seen: dict[str, tuple] = {}  # file: its state when read, and its content, None if it has none


def _state(path: str) -> tuple[int, int] | None:
    try:
        facts = os.stat(path)
    except OSError:  # reading it says why
        return None
    return facts.st_mtime_ns, facts.st_size


def _read(path: str):
    state = _state(path)
    performance = native.performances().Performance.load(path)
    footage = performance.footage[1] if performance.footage else ""
    _seen[path] = state, _Content(footage, capture_of(performance))
    return performance


def _content(path: str) -> _Content | None:
    """Of a file that may have been read before; None of one that cannot be."""
    state = _state(path)
    if path not in _seen or _seen[path][0] != state:  # panels ask at every drawing
        try:
            _read(path)
        except native.known_errors():
            _seen[path] = state, None
    return _seen[path][1]


def _is_of(path: str, fingerprint: str) -> bool:
    """Whether a file is a take of the footage with a fingerprint, as far as either is known."""
    if not fingerprint:
        return True
    content = _content(path)
    return content is not None and content.footage in ("", fingerprint)


def capture_of(performance) -> str:
    """Digest of what a `mimetic.performance.Performance` has measured: the values of each frame,
    how far these may be off, and where the face was lost."""
    digest = hashlib.sha256()
    for name in MEASURED:
        values = getattr(performance, name)
        digest.update(name.encode())
        if values is not None:
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


def holds(path: str, row) -> bool:
    """Whether a file has what a baked take (`take_rows.MimeticTake`) was made from, as far as that
    is known."""
    content = _content(path)
    return not row.capture or (content is not None and content.capture == row.capture)


def note_baked(row, path: str) -> None:
    """Has a baked take remember the file that it is made from."""
    path = os.path.abspath(path)
    content = _content(path)
    row.performance = native.shown_text().shown(Path(path).name)
    row.performance_path = _relative(path, bpy.data.filepath)
    row.capture = content.capture if content else ""


def of_baked(row) -> Take | None:
    """The captured take that a baked one was made from: in the file that it remembers, or in one of
    that name that the .blend uses or lists, or beside it or beside those. Where none `holds` it,
    the first of them; None if there is none."""
    found = _named_as(row)
    if len(found) > 1:
        found.sort(key=lambda take: not holds(take.path, row))
    return next(iter(found), None)


def _named_as(row) -> list[Take]:
    """Those that may be what a baked take was made from, the likeliest first. Each clip may have a
    file of that name, and each folder."""
    name = row.performance
    holders = [holder for holder in _holders() if holder.performance_path]
    same = [h for h in holders if name_of(h) == name and find(h)]
    same.sort(key=lambda h: bool(row.footage) and _footage_of(h) != row.footage)
    known = {}
    for holder in same:
        is_of_scene, path = isinstance(holder.id_data, bpy.types.Scene), find(holder)
        owner = () if is_of_scene else (holder.id_data.name, _footage_of(holder))
        known.setdefault(os.path.normpath(path), Take(path, *owner))
    folders = [bpy.path.abspath("//")] if bpy.data.filepath else []
    folders += [os.path.dirname(path_of(holder)) for holder in holders]
    own = [path_of(row)] if row.performance_path else []
    beside = [os.path.normpath(os.path.join(folder, name)) for folder in folders]
    paths = dict.fromkeys([*own, *known, *beside])
    return [known.get(path) or Take(path) for path in paths if os.path.isfile(path)]


def _baked_rows() -> list:
    """Every baked take in the .blend itself, which remembers its file."""
    return [row for obj in bpy.data.objects if not obj.library for row in obj.mimetic.takes]


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
    _references.extend((row, path_of(row)) for row in _baked_rows() if row.performance_path)
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
