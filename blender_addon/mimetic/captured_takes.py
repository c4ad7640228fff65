# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of a clip's captured takes: which there are, which is used, what is known of each."""

from __future__ import annotations

import datetime
import os
from pathlib import Path

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from . import clips, native, takes


def keep(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None, path: str, facts) -> None:
    """Makes a file the take that is used, of a clip and in its list, or of the scene while it has
    no clip; facts: a mimetic.performance.take_facts.TakeFacts of it."""
    if clip is None:
        takes.keep(scene, clip, path)
        return
    _note_used(clip)
    _note(takes.keep(scene, clip, path), path, facts)


def keep_read(scene: bpy.types.Scene, clip, path: str, performance) -> None:
    """The same of a Performance that was read."""
    keep(scene, clip, path, native.take_facts().facts_of(performance))


def keep_for(scene: bpy.types.Scene, clip_name: str, path: str, facts) -> list[str]:
    """The same for the clip of a name; returns what the user should know."""
    clip = bpy.data.movieclips.get(clip_name)
    if clip is None:  # deleted while the job ran
        return [
            rpt_("{clip} is gone from this file, the take is {file}").format(
                clip=clip_name, file=path
            )
        ]
    keep(scene, clip, path, facts)
    return []


def adopt(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> None:
    """Gives a clip that has no take the one that was loaded before it, if it can be the clip's."""
    loose = takes.of_clip(scene, None)
    path = takes.find(loose) if loose and not takes.of_clip(scene, clip) else ""
    if not path:
        return
    try:
        performance = takes.load(takes.Take(path, clip.name, clips.fingerprint(clip)))
    except native.known_errors():
        return
    keep_read(scene, clip, path, performance)
    loose.performance_path = ""


def of_clip(clip: bpy.types.MovieClip | None):
    """The rows, oldest first."""
    record = clips.find(clip) if clip else None
    return record.captured if record else ()


def is_used(record, row) -> bool:
    """Whether a row is the take that buttons and overlays use."""
    return bool(record.performance_path) and takes.path_of(record) == takes.path_of(row)


def find(clip: bpy.types.MovieClip, name: str):
    """A row by its name, or the one that is shown; raises InvalidInput."""
    rows, record = of_clip(clip), clips.find(clip)
    if name and name not in rows:
        names = ", ".join(row.name for row in rows) or rpt_("none")
        raise native.invalid_input(
            rpt_("{clip} has no captured take {take}: it has {names}").format(
                clip=clip.name, take=name, names=names
            )
        )
    if name:
        return rows[name]
    return rows[min(max(record.active_captured, 0), len(rows) - 1)]


def use(scene: bpy.types.Scene, clip: bpy.types.MovieClip, row):
    """Has buttons and overlays use it; returns its file and facts. Raises InvalidInput, or what
    reading it raises, and changes nothing then."""
    path = takes.find(row)
    if not path:
        raise native.invalid_input(
            rpt_(
                "{name} is missing: look for it (Find Missing Files), or take it off the list "
                "(Remove Captured Take)"
            ).format(name=takes.name_of(row))
        )
    performance = takes.load(takes.Take(path, clip.name, clips.fingerprint(clip)))
    facts = native.take_facts().facts_of(performance)
    row.performance_path = path  # it may have been found beside the .blend
    keep(scene, clip, path, facts)
    return path, facts


def remove(clip: bpy.types.MovieClip, row) -> None:
    """Takes it off the list; its file stays. Raises InvalidInput for the one that is used."""
    record = clips.ensure(clip)
    if is_used(record, row):
        raise native.invalid_input(
            rpt_("{take} is the take that is used: use another one first").format(take=row.name)
        )
    index = record.captured.find(row.name)
    record.captured.remove(index)
    record.active_captured = min(index, len(record.captured) - 1)


def settings_of(row) -> str:
    """How it was captured."""
    parts = [iface_("lens of {focal:.0f} mm on 36 mm").format(focal=row.focal_mm)]
    parts += [iface_("head alone")] if row.is_head_alone else []
    parts += [iface_("calibrated")] if row.is_calibrated else []
    if row.num_corrected:
        text = iface_("{count} frames corrected")
        text = text if row.num_corrected > 1 else iface_("1 frame corrected")
        parts.append(text.format(count=row.num_corrected))
    return ", ".join(parts)


def _note_used(clip: bpy.types.MovieClip) -> None:
    """Lists the take that is used, if nothing has: of an earlier version, or set by a script."""
    record = clips.find(clip)
    path = takes.find(record) if record and record.performance_path else ""
    if not path or any(is_used(record, row) for row in record.captured):
        return
    try:
        performance = takes.load(takes.Take(path, clip.name, clips.fingerprint(clip)))
    except native.known_errors():
        return
    _note(record, path, native.take_facts().facts_of(performance))


def _note(record, path: str, facts) -> None:
    """Lists a take, or what is new of one that is in the list."""
    path = os.path.normpath(os.path.abspath(path))
    rows = record.captured
    row = next((one for one in rows if takes.path_of(one) == path), None)
    if row is None:
        row = rows.add()
        row.name = _free_name(record, path)
    row.performance_path, row.capture = record.performance_path, record.capture
    row.performance_folder = record.performance_folder
    row.first, row.last = facts.first, facts.last
    row.quality, row.num_lost = facts.quality, facts.num_held
    row.focal_mm, row.num_corrected = facts.focal_mm, facts.num_corrected
    row.is_calibrated, row.is_head_alone = facts.is_calibrated, facts.is_head_alone
    written = datetime.datetime.fromtimestamp(os.stat(path).st_mtime).astimezone()
    row.date = written.strftime("%Y-%m-%d %H:%M")
    record.active_captured = rows.find(row.name)


def _free_name(record, path: str) -> str:
    """Its file's without what all end in, and of folders where several files have that name."""
    *folders, file = map(native.shown_text().shown, Path(path).parts)
    name = file.removesuffix(".npz").removesuffix(".performance")
    while name in record.captured and folders:
        name = f"{folders.pop()}/{name}"
    return name
