# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of lists: a name, shortened where the sidebar is narrow, and figures in columns after it."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from bpy.app.translations import pgettext_iface as iface_

from .paragraph import one_line, units_of

AROUND = 2.2  # icons wide: a list's frame, its scroll bar, and the buttons beside it


def row_name(name: str, num_beside: float) -> str:
    """As it fits into a row of a list; num_beside: how many icons wide the rest of the row is."""
    return one_line(name, AROUND + num_beside)


def figures(row: bpy.types.UILayout, texts: Iterable[str], of_all: list[list[str]]) -> None:
    """A column for each of the texts, as wide as the widest of all rows is."""
    for text, width in zip(texts, widths(of_all), strict=True):
        if width:
            cell = row.row(align=True)
            cell.ui_units_x = width
            cell.label(text=text)


def range_and_lost(take) -> list[str]:
    """Of a row that has them: first and last frame, and how many were lost."""
    lost = iface_("{count} lost").format(count=take.num_lost) if take.num_lost else ""
    return [iface_("{first} to {last}").format(first=take.first, last=take.last), lost]


def widths(of_all: list[list[str]]) -> list[float]:
    """Of the columns, in icons; 0 where no row has anything."""
    return [max(map(units_of, column)) for column in zip(*of_all, strict=True)]
