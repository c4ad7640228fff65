# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds a button on a picture of the screen by the colour that Blender's theme gives it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.image import imread

COLOURS = {"lit": (71, 114, 179), "plain": (84, 84, 84)}  # Blender's dark theme, of buttons
LEAST_WIDTH, LEAST_HEIGHT = 60, 12  # pixels


def find_button(
    picture: Path, box: tuple[int, int, int, int], colour: str
) -> tuple[int, int] | None:
    """The middle of the topmost button of a colour within a box (left, top, width, height), pixels
    from the screen's top left; None where none is seen."""
    left, top, width, height = box
    pixels = np.round(255 * imread(picture)[top : top + height, left : left + width, :3])
    is_colour = (np.abs(pixels - COLOURS[colour]) <= 4).all(axis=2)
    rows = np.flatnonzero(is_colour.sum(axis=1) >= LEAST_WIDTH)
    for run in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
        if len(run) >= LEAST_HEIGHT:
            columns = np.flatnonzero(is_colour[run].sum(axis=0) >= LEAST_HEIGHT // 2)
            return left + int(np.median(columns)), top + int(run[len(run) // 2])
    return None
