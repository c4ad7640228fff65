# SPDX-License-Identifier: GPL-3.0-or-later
"""The take of the clip on show, read once for all that draws it or puts corrections on it."""

from __future__ import annotations

import os

from . import native, scene_in, takes

NUM_KEPT = 2  # takes: editors may show different clips

# Takes that were read, oldest first: what says that it is still the same, its Performance or error
_read: dict[takes.Take, tuple] = {}


def performance(context):
    """The take's Performance, the same object until its file or its clip is another one.

    To be asked where `scene_in.no_take` has nothing to say. Raises what `takes.load` raises.
    """
    return of(scene_in.take(context))


def of(take: takes.Take):
    """The same of any captured take."""
    facts = os.stat(take.path)
    stamp = (facts.st_mtime_ns, facts.st_size)
    if take not in _read or _read[take][0] != stamp:
        try:
            found = takes.load(take)
        except native.known_errors() as error:
            found = error
        _read.pop(take, None)
        while len(_read) >= NUM_KEPT:
            del _read[next(iter(_read))]
        _read[take] = (stamp, found)
    found = _read[take][1]
    if isinstance(found, Exception):
        raise found.with_traceback(None)
    return found


def last_read(context):
    """The take's Performance if it was read before, else None; the clip has a take."""
    found = _read.get(scene_in.take(context), (None, None))[1]
    return None if isinstance(found, Exception) else found


def performance_or_none(context):
    """The same for drawing: None where there is none that could be drawn."""
    holder = takes.of_clip(context.scene, scene_in.clip_of(context))
    if holder is None or not takes.find(holder):
        return None
    try:
        return performance(context)
    except native.known_errors():  # the buttons say why
        return None


def forget() -> None:
    _read.clear()
