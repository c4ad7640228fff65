# SPDX-License-Identifier: GPL-3.0-or-later
"""Sentences in a panel, whose labels never break their lines by themselves."""

from __future__ import annotations

from collections.abc import Callable

import blf
import bpy
from bpy.app.translations import pgettext_iface as iface_

MARGINS = 60  # of a sidebar's width, pixels at a UI scale of 1: tabs, frame of the panel, label
LETTERS = 44  # in a line where there is no window to measure in


def paragraph(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """As many labels as the sidebar's width asks for; the icon stands before the first."""
    limit, width_of = _measure()
    beside = width_of("mmm") if icon != "NONE" else 0
    # Whole: no translation has its lines
    text = iface_(text)
    for i, line in enumerate(lines(text, limit - beside, width_of)):
        layout.label(text=line, icon="NONE" if i else icon)


def lines(text: str, limit: float, width_of: Callable[[str], float]) -> list[str]:
    """Of at most `limit` by `width_of`, if no single word is wider."""
    broken = [""] if text else []
    for word in text.split():
        if broken[-1] and width_of(f"{broken[-1]} {word}") > limit:
            broken.append("")
        broken[-1] = f"{broken[-1]} {word}".strip()
    return broken


def _measure() -> tuple[float, Callable[[str], float]]:
    """The width that a line may have, and of a text what counts."""
    region = bpy.context.region
    if bpy.app.background or region is None:
        return LETTERS, len
    preferences = bpy.context.preferences
    scale = preferences.system.ui_scale
    blf.size(0, preferences.ui_styles[0].widget.points * scale)
    return region.width - MARGINS * scale, lambda text: blf.dimensions(0, text)[0]
