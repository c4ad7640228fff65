# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences in a panel, whose labels never break their lines by themselves."""

from __future__ import annotations

from collections.abc import Callable

import blf
import bpy
from bpy.app.translations import pgettext_iface as iface_

from .. import outcome

MARGINS = 60  # of a sidebar's width, pixels at a UI scale of 1: tabs, frame of the panel, label
UNIT = 20  # pixels at a UI scale of 1: an icon, or a button that shows nothing else
LETTERS, LETTERS_OF_UNIT = 44, 4  # in a line where there is no window to measure in
BREAKS = "_-./\\"  # after which a file's name is broken


def paragraph(
    layout: bpy.types.UILayout, text: str, icon: str = "NONE", num_beside: float = 0
) -> None:
    """As many labels as the sidebar's width asks for; the icon stands before the first.

    num_beside: icons or buttons that stand beside the labels, in the same row.
    """
    limit, width_of, unit = _measure()
    beside = unit * num_beside + (width_of("mmm") if icon != "NONE" else 0)
    # Whole: no translation has its lines
    text = outcome.readable(iface_(text))
    for i, line in enumerate(lines(text, limit - beside, width_of)):
        layout.label(text=line, icon="NONE" if i else icon)


def one_line(text: str, num_beside: float = 0) -> str:
    """The text, without its middle where that does not fit beside so many icons or buttons."""
    limit, width_of, unit = _measure()
    return shortened(outcome.readable(text), limit - unit * num_beside, width_of)


def units_of(text: str) -> float:
    """How many icons wide a label is."""
    _, width_of, unit = _measure()
    return (width_of(text) + width_of("m")) / unit if text else 0.0


def lines(text: str, limit: float, width_of: Callable[[str], float]) -> list[str]:
    """Of at most `limit` by `width_of`; a word that is wider is broken."""
    broken = [""] if text else []
    for word in text.split():
        first, *others = _pieces(word, limit, width_of)
        if broken[-1] and width_of(f"{broken[-1]} {first}") > limit:
            broken.append("")
        broken[-1] = f"{broken[-1]} {first}".strip()
        broken += others
    return broken


def shortened(text: str, limit: float, width_of: Callable[[str], float]) -> str:
    """Of at most `limit`: names of a series differ at their ends."""
    if width_of(text) <= limit:
        return text
    kept = len(text) - 1
    while kept > 2 and width_of(_without_middle(text, kept)) > limit:
        kept -= 1
    return _without_middle(text, kept)


def _without_middle(text: str, num_kept: int) -> str:
    num_last = num_kept // 2
    return f"{text[: num_kept - num_last]}…{text[len(text) - num_last :]}"


def _pieces(word: str, limit: float, width_of: Callable[[str], float]) -> list[str]:
    """Parts of a word that fit; those of a file's name end where it has a mark, if they can."""
    pieces = []
    while len(word) > 1 and width_of(word) > limit:
        end = len(word) - 1
        while end > 1 and width_of(word[:end]) > limit:
            end -= 1
        at_mark = 1 + max(word.rfind(mark, 0, end) for mark in BREAKS)
        end = at_mark if at_mark > end // 2 else end
        pieces.append(word[:end])
        word = word[end:]
    return [*pieces, word]


def _measure() -> tuple[float, Callable[[str], float], float]:
    """The width that a line may have, of a text what counts, and that of an icon."""
    region = bpy.context.region
    if bpy.app.background or region is None:
        return LETTERS, len, LETTERS_OF_UNIT
    preferences = bpy.context.preferences
    scale = preferences.system.ui_scale
    blf.size(0, preferences.ui_styles[0].widget.points * scale)
    width = region.width - MARGINS * scale
    return width, lambda text: blf.dimensions(0, text)[0], UNIT * scale
