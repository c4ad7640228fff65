# SPDX-License-Identifier: GPL-3.0-or-later
"""Captured takes: performance files, which belong to a clip or to none. (What a bake makes of one
is a baked take: `take_rows`.)

The .blend names a take's file relative to itself, so that both may move together, also when it is
saved elsewhere. A file that is not where it was is looked for beside the .blend. What came from
another .blend names files relative to that one: so it is noted which folder was meant and what the
file held, and no other capture in a file of the same name is taken for it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.app.handlers import persistent
from bpy.app.translations import pgettext_rpt as rpt_

from . import clips, compat, handlers, native, performance_files

# Of a new file's name, which most systems let have 255: room for a number and the ending
STEM_BYTES = 220


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
    notes, path = performance.notes or [], str(new.folder)
    try:
        path = new.path()
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
    if len(os.fsencode(stem)) > STEM_BYTES:  # a character that is cut in two goes as a whole
        stem = os.fsencode(stem)[:STEM_BYTES].decode("utf-8", "ignore")
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
    performance = performance_files.read(take.path)
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
    performance = performance_files.read(path)
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
    _note_file(holder, os.path.abspath(path))
    return holder


def of_clip(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None):
    """What holds the take's path: of the clip, or of the scene while it has no clip; or None."""
    holder = scene.mimetic if clip is None else clips.find(clip)
    return holder if holder is not None and holder.performance_path else None


def name_of(holder) -> str:
    return Path(holder.performance_path.replace("\\", "/").removeprefix("//")).name


def find(holder) -> str:
    """Where the file is that a holder names, there or, if it is of the holder's footage and holds
    the capture that was noted, beside the .blend; "" if it is missing."""
    path = _in_place(holder)
    if path or not bpy.data.filepath:
        return path
    beside = bpy.path.abspath(f"//{name_of(holder)}")
    if not os.path.isfile(beside) or not performance_files.holds(beside, holder):
        return ""
    return beside if performance_files.is_of(beside, _footage_of(holder)) else ""


def note_baked(row, path: str) -> None:
    """Has a baked take remember the file that it is made from."""
    path = os.path.abspath(path)
    row.performance = native.shown_text().shown(Path(path).name)
    _note_file(row, path)


def of_baked(row) -> Take | None:
    """The captured take that a baked one was made from: in the file that it remembers, or in one of
    that name that the .blend uses or lists, or beside it or beside those. Where none `holds` it,
    the first of them; None if there is none."""
    found = _named_as(row)
    if len(found) > 1:
        found.sort(key=lambda take: not performance_files.holds(take.path, row))
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
    _note_file(holder, path)
    return True


def _holders() -> list:
    """Everything in the .blend itself that may name a take: what is used, and the lists' rows."""
    blocks = [*bpy.data.scenes, *bpy.data.movieclips]
    return [holder for block in blocks if not block.library for holder in _holders_of(block)]


def _holders_of(block: bpy.types.ID) -> list:
    """What of a scene, clip or object may name a performance file."""
    if isinstance(block, bpy.types.Scene):
        return [block.mimetic]
    if isinstance(block, bpy.types.Object):
        return list(block.mimetic.takes)
    if not isinstance(block, bpy.types.MovieClip):
        return []
    records = list(block.mimetic.footage)
    return records + [row for record in records for row in record.captured]


def _footage_of(holder) -> str:
    """The fingerprint of the footage that a holder's take is of, "" where that is not known."""
    if isinstance(holder.id_data, bpy.types.Scene):
        return ""
    records = holder.id_data.mimetic.footage
    return next(r.name for r in records if holder == r or holder in list(r.captured))


def path_of(holder) -> str:
    """Where the file that a holder names should be."""
    return _in_place(holder) or _places(holder)[0]


def _in_place(holder, library: bpy.types.Library | None = None) -> str:
    """The file that a holder names where that says it is, "" if it is not there.

    library: which the holder comes from, of one that was just appended
    """
    holder = _original(holder) or holder
    places = _places(holder, library)
    if len(places) == 1:
        return places[0] if os.path.isfile(places[0]) else ""
    # The .blend was moved with its files, or this came from another: as what the file holds says
    here = (place for place in places if os.path.isfile(place))
    return next((place for place in here if performance_files.holds(place, holder)), "")


def _places(holder, library: bpy.types.Library | None = None) -> list[str]:
    """Where the file may be that a holder names: as seen from the .blend that the holder is in,
    and from where it was named."""
    holder = _original(holder) or holder
    name, folder = holder.performance_path, holder.performance_folder
    places = [bpy.path.abspath(name, library=library or holder.id_data.library)]
    if folder:
        places.append(bpy.path.abspath(name, start=folder))
    return list(dict.fromkeys(map(os.path.normpath, places)))


def _original(row):
    """The row of the linked file that an override's baked take comes from, or None."""
    override = row.id_data.override_library
    if not override or not override.reference or not isinstance(row.id_data, bpy.types.Object):
        return None
    original = override.reference.mimetic.takes.get(row.name)
    if original is None or original.capture != row.capture:
        return None
    return _original(original) or original


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


def _note_file(holder, path: str) -> None:
    """Has a holder name a file as it is now."""
    content = performance_files.content_of(path)
    holder.capture = content.capture if content else ""
    _name_as(holder, path, bpy.data.filepath)


def _name_as(holder, path: str, blend: str) -> None:
    name, folder = _relative(path, blend), os.path.dirname(blend)
    if holder.performance_path != name:
        holder.performance_path = name
    if holder.performance_folder != folder:
        holder.performance_folder = folder


_references: list[tuple] = []  # while the .blend is saved: what named a take, and its file


@persistent
def name_from_new_place(blend: str, *_) -> None:
    """Before saving: takes are named as seen from where the .blend will be."""
    for clip in bpy.data.movieclips:
        clips.settle(clip)
    holders = [(holder, find(holder)) for holder in _holders() if holder.performance_path]
    for holder, path in holders:
        if path and (not holder.capture or performance_files.was_read(path)):
            _note_file(holder, path)  # of an earlier version, or written anew by others
    rows = [row for row in _baked_rows() if row.performance_path and not _original(row)]
    holders += [(row, _in_place(row)) for row in rows]
    # Of one that may be in either of two places, and is in neither, both are still to be known
    holders = [(h, path or path_of(h)) for h, path in holders if path or len(_places(h)) == 1]
    _references[:] = holders
    _name(blend)


@persistent
def name_from_own_place(*_) -> None:
    """After saving a copy, or after saving failed: the open .blend is where it was."""
    _name(bpy.data.filepath)
    _references.clear()


def _name(blend: str) -> None:
    for holder, path in _references:
        _name_as(holder, path, blend)


@persistent
def open_file(*_) -> None:
    clips.migrate()
    for block in (*bpy.data.scenes, *bpy.data.movieclips, *bpy.data.objects):
        if block.library:
            _name_whole(block, block.library)


@persistent
def name_imported(imported, *_) -> None:
    """After linking and appending: files are named as seen from this .blend."""
    for item in imported.import_items:
        if item.id and item.source_library and item.append_action != "REUSE_LOCAL":
            _name_whole(item.id, item.source_library)


def _name_whole(block: bpy.types.ID, library: bpy.types.Library) -> None:
    """Has what comes from another .blend name its files by whole paths, which are right as well
    once linked data is made local; saving makes them relative."""
    for holder in _holders_of(block):
        if holder.performance_path and not _original(holder):
            path = _in_place(holder, library) or _places(holder, library)[0]
            _name_as(holder, path, "")


HANDLERS = (
    (bpy.app.handlers.save_pre, name_from_new_place),
    (bpy.app.handlers.save_post, name_from_own_place),
    (bpy.app.handlers.save_post_fail, name_from_own_place),
    (bpy.app.handlers.load_post, open_file),
    *((called, name_imported) for called in compat.imports()),
)


def register() -> None:
    handlers.add(HANDLERS)
    # A file that was open before the extension was; none may be touched while it registers
    bpy.app.timers.register(open_file, first_interval=0.0)


def unregister() -> None:
    if bpy.app.timers.is_registered(open_file):
        bpy.app.timers.unregister(open_file)
    handlers.remove(HANDLERS)
