# SPDX-License-Identifier: GPL-3.0-or-later
"""What belongs to a clip: the person's fit with pins and calibration, and the take.

It is kept by the content of the clip's file: a file that was moved or renamed still has it, and
another file at the old path does not; each content gets back only what is its own.
"""

from __future__ import annotations

import os

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from . import clip_time, native

_read: dict[str, tuple[tuple, str]] = {}  # path: the file's state when read, and its fingerprint


def name_of(clip: bpy.types.MovieClip | None) -> str:
    return clip.name if clip else ""


def named(name: str) -> bpy.types.MovieClip:
    """The clip that a job has worked on; raises InvalidInput if it is gone by now."""
    clip = bpy.data.movieclips.get(name)
    if clip is None:
        raise native.invalid_input(
            rpt_("{name} was removed or renamed meanwhile: load it again").format(name=name)
        )
    return clip


def path_of(clip: bpy.types.MovieClip) -> str:
    """The clip's file; of an image sequence the first picture."""
    return bpy.path.abspath(clip.filepath, library=clip.library)


def source_of(clip: bpy.types.MovieClip, scene: bpy.types.Scene):
    """What the package reads the clip's frames from; raises what `known_errors` has.

    Pictures have no rate: a sequence plays at the scene's.
    """
    if clip.source == "MOVIE":
        return path_of(clip)
    return native.footage().ImageSequence(path_of(clip), clip_time.scene_rate(scene))


def is_missing(clip: bpy.types.MovieClip) -> bool:
    return not os.path.isfile(path_of(clip))


def fingerprint(clip: bpy.types.MovieClip) -> str:
    """Of the clip's file as it is now; if it is missing, of the one seen last; "" for none."""
    path = path_of(clip)
    try:
        state = os.stat(path)
    except (OSError, ValueError):
        return clip.mimetic.fingerprint
    # Panels ask at every drawing: a file is read again only when it may have changed, pictures
    # when the first did, or when one came or went
    now = (state.st_size, state.st_mtime_ns, state.st_ctime_ns, state.st_ino)
    if clip.source == "SEQUENCE":
        now += (os.stat(os.path.dirname(path)).st_mtime_ns,)
    if path not in _read or _read[path][0] != now:
        try:
            source = native.footage().opened(path)
            _read[path] = (now, native.clip_fingerprint().fingerprint(source))
        except native.known_errors():
            return clip.mimetic.fingerprint
    return _read[path][1]


def find(clip: bpy.types.MovieClip):
    """The MimeticFootage of the clip's content, also if another clip of the .blend keeps it."""
    mark = fingerprint(clip)
    own = clip.mimetic.footage
    # What was kept before any file was seen, in a .blend of an earlier version, has no name
    record = own.get(mark) or own.get("")
    if record is None and mark:
        records = (other.mimetic.footage.get(mark) for other in bpy.data.movieclips)
        record = next(filter(None, records), None)
    return record


def ensure(clip: bpy.types.MovieClip):
    """As `find`, but makes one where there is none."""
    settle(clip)
    clip.mimetic.fingerprint = fingerprint(clip)
    record = find(clip)
    # What is written to linked data Blender forgets on saving, too
    if record is None or (record.id_data.library and not clip.library):
        own = clip.mimetic.footage.add()
        if record is not None:
            _copy(record, own)
        record = own
        record.name = clip.mimetic.fingerprint
        clip.use_fake_user = True  # Blender forgets on saving what nothing shows
    return record


def _copy(record, own) -> None:
    """Gives a record, or a row of one, what a linked one holds; files by their whole paths."""
    for prop in record.bl_rna.properties:
        name = prop.identifier
        if prop.type == "COLLECTION":
            for row in getattr(record, name):
                _copy(row, getattr(own, name).add())
        elif name == "performance_path":
            path = bpy.path.abspath(record.performance_path, library=record.id_data.library)
            own.performance_path = path
        elif not prop.is_readonly:
            setattr(own, name, getattr(record, name))


def settle(clip: bpy.types.MovieClip) -> None:
    """Notes which content the clip has, if none was noted yet."""
    if native.problem() or clip.library:
        return
    mark = fingerprint(clip)
    clip.mimetic.fingerprint = clip.mimetic.fingerprint or mark
    record = clip.mimetic.footage.get("")
    if mark and record and mark not in clip.mimetic.footage:
        record.name = mark


def with_content(mark: str) -> bpy.types.MovieClip | None:
    """The .blend's own clip with a content; one whose file is there before one whose is not."""
    clips = [c for c in bpy.data.movieclips if not c.library and fingerprint(c) == mark]
    return min(clips, key=is_missing, default=None)


def change_of(clip: bpy.types.MovieClip) -> str:
    """A warning that the file has another content than the one that data is kept for, or ""."""
    before = clip.mimetic.fingerprint
    if not before or before not in clip.mimetic.footage or fingerprint(clip) == before:
        return ""
    return iface_(
        "{clip} now has another content: face and take of the earlier one are "
        "kept, and come back with it"
    ).format(clip=clip.name)


def migrate() -> None:
    """What earlier versions kept with the scene goes to the scene's clip."""
    earlier = {clip.name for clip in bpy.data.movieclips if not clip.mimetic.fingerprint}
    for clip in bpy.data.movieclips:
        settle(clip)
        own = clip.mimetic
        if own.landmarks_of and not clip.library and not own.is_property_set("landmark_offset"):
            own.landmark_offset = clip.frame_offset
    for scene in bpy.data.scenes:
        settings, clip = scene.mimetic, scene.mimetic.clip
        if scene.library or clip is None or clip.library:
            continue
        if not settings.face_fit and (not settings.performance_path or clip.name not in earlier):
            continue
        record = ensure(clip)
        if settings.face_fit and not record.face_fit:
            record.face_fit, clip.mimetic.landmarks_of = settings.face_fit, record.name
            clip.mimetic.landmark_offset = clip.frame_offset
        if not record.performance_path:
            record.performance_path = settings.performance_path
        settings.face_fit = settings.performance_path = ""
