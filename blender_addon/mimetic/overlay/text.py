# SPDX-License-Identifier: GPL-3.0-or-later
"""Words over an editor's picture, white with a shadow: readable on light and on dark."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import blf

SIZE = 12  # at a UI scale of 1


@contextmanager
def style(ui_scale: float) -> Iterator[None]:
    """What `write` and `blf.dimensions` use."""
    blf.size(0, SIZE * ui_scale)
    blf.color(0, 1, 1, 1, 1)
    blf.enable(0, blf.SHADOW)
    blf.shadow(0, 3, 0, 0, 0, 1)
    try:
        yield
    finally:
        blf.disable(0, blf.SHADOW)


def write(words: str, x: float, y: float) -> None:
    blf.position(0, x, y, 0)
    blf.draw(0, words)
