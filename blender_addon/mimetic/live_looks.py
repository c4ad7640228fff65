# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks that are taught while a live session runs: what was kept, until the next session."""

from __future__ import annotations

from pathlib import Path

import bpy
from bpy.app.handlers import persistent
from bpy.app.translations import pgettext_rpt as rpt_

from . import handlers, look_settings, native, takes

MOST_PAIRS = 3  # of looks that are most alike, which are told

keeper: object = None  # mimetic.puppet.look_keeper.LookKeeper of the last session that taught


def keeper_of(settings):
    """A LookKeeper for a session, or None where nothing is taught; raises what `known_errors` has.

    Looks with a frame are asked for at once, where a clip is played from its beginning.
    """
    global keeper
    if not settings.use_teaching:
        return None
    old = None
    if settings.taught_set:
        old = native.puppet("templates").TaughtSet.load(bpy.path.abspath(settings.taught_set))
    made = native.puppet("look_keeper").LookKeeper(old)
    for i, look in enumerate(settings.looks):
        if look.frame and settings.source == "CLIP":
            if reason := look_settings.obstacle(look):
                settings.active_look = i  # the one that is meant
                raise native.invalid_input(rpt_(reason))
            made.ask(look_settings.as_look(look, look.frame))
    keeper = made
    return made


def kept() -> list[str]:
    """Names of the looks that were kept."""
    return keeper.kept if keeper else []


def chosen(settings):
    """The look of the list that is chosen, or None."""
    looks, i = settings.looks, settings.active_look
    return looks[i] if 0 <= i < len(looks) else None


def choose_next(settings) -> None:
    """The first look after the chosen one that was not kept yet."""
    done = {*kept(), settings.looks[settings.active_look].name}
    count = len(settings.looks)
    order = ((settings.active_look + step) % count for step in range(1, count))
    for i in order:
        if settings.looks[i].name not in done and not settings.looks[i].frame:
            settings.active_look = i
            return


def save(path: str) -> tuple[str, list[str], dict]:
    """Makes and writes the set; returns where it is, lines of advice, facts for scripts.

    path: "" for a new file beside the .blend, or with the user's files. Raises what `known_errors`
    has, and OSError.
    """
    if keeper is None:
        raise native.invalid_input("No look was kept yet")
    taught = keeper.taught()
    path = bpy.path.abspath(path) if path else takes.new_set_path()
    if Path(path).suffix != ".npz":
        raise native.invalid_input(rpt_("{path}: a taught set is an .npz file").format(path=path))
    taught.save(path)
    parts = native.puppet("separability")
    pairs = parts.separability(taught)
    lines = parts.advice(pairs) or [rpt_("All looks are told apart")]
    lines += [
        rpt_("most alike: {first} and {second} by the {part}, d' {d_prime:.1f}").format(
            first=pair.first, second=pair.second, part=pair.part, d_prime=pair.d_prime
        )
        for pair in pairs[:MOST_PAIRS]
    ]
    facts = {"path": path, "looks": taught.looks, "templates": len(taught.template_parts)}
    return path, lines, facts


@persistent
def _forget(*_) -> None:
    global keeper
    keeper = None


_HANDLERS = ((bpy.app.handlers.load_pre, _forget),)


def register() -> None:
    handlers.add(_HANDLERS)


def unregister() -> None:
    handlers.remove(_HANDLERS)
    _forget()
