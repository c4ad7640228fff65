# SPDX-License-Identifier: GPL-3.0-or-later
"""The take of the clip on show, read once for all that draws it or puts corrections on it."""

from __future__ import annotations

import os

from . import native, scene_in, takes

_last: tuple | None = None  # what says that a take is still the same, its Performance or an error


def performance(context):
    """The take's Performance, the same object until its file or its clip is another one.

    To be asked where `scene_in.no_take` has nothing to say. Raises what `takes.load` raises.
    """
    global _last
    take = scene_in.take(context)
    facts = os.stat(take.path)
    stamp = (take, facts.st_mtime_ns, facts.st_size)
    if _last is None or _last[0] != stamp:
        try:
            _last = (stamp, takes.load(take))
        except native.known_errors() as error:
            _last = (stamp, error)
    if isinstance(_last[1], Exception):
        raise _last[1].with_traceback(None)
    return _last[1]


def last_read(context):
    """The take's Performance if it was read before, else None; the clip has a take."""
    is_it = _last is not None and _last[0][0] == scene_in.take(context)
    return _last[1] if is_it and not isinstance(_last[1], Exception) else None


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
    global _last
    _last = None
