# SPDX-License-Identifier: GPL-3.0-or-later
"""A clip walked forwards or backwards in bounded memory."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mimetic.media.footage import Footage

BACKWARD_BYTES = 128 << 20  # of frames held to walk a clip backwards


def frames_backward(
    footage: Footage, first: int, last: int
) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Frames from `first` down to `last`, in runs that fit in memory."""
    width, height = footage.size
    num_held = max(1, BACKWARD_BYTES // (3 * width * height))
    while first >= last:
        start = max(last, first - num_held + 1)
        yield from reversed(list(footage.frames(start, first)))
        first = start - 1


def frames_away(footage: Footage, start: int, end: int) -> Iterator[tuple[int, NDArray[np.uint8]]]:
    """Frames from the one beside `start` to `end`, whichever way that is; none if it is `start`."""
    if end > start:
        yield from footage.frames(start + 1, end)
    else:
        yield from frames_backward(footage, start - 1, end)
