# SPDX-License-Identifier: GPL-3.0-or-later
"""The colours of the strip of quality in a photograph of the window."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.image import imread

# Red, green, blue: least and most of each
COLOURS = {
    "lost": ((0.6, 0.0, 0.0), (1.0, 0.3, 0.35)),
    "good": ((0.0, 0.5, 0.0), (0.5, 1.0, 0.45)),
    "corrected": ((0.0, 0.3, 0.75), (0.4, 0.7, 1.0)),
}


def strip_colours(picture: Path, columns: Sequence[Sequence[int]]) -> list[set[str]]:
    """What is seen in each of `strip_columns`, two pixels high at least; rows count from the
    bottom."""
    pixels = imread(picture)[::-1, :, :3]
    return [_seen(pixels[low:high, x]) for x, low, high in columns]


def _seen(column: np.ndarray) -> set[str]:
    return {
        name
        for name, (least, most) in COLOURS.items()
        if ((column >= least) & (column <= most)).all(axis=1).sum() >= 2
    }
