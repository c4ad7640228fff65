# SPDX-License-Identifier: GPL-3.0-or-later
"""What documents about a clip have in common: frames, rate, picture and camera, checked."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.media.timing import LAST_FRAME, check_rate
from mimetic.shared.pinhole import is_pinhole

LARGEST_SIDE = 16384  # pixels


def check_clip(
    what: str,
    frame: NDArray[np.int64],
    fps: float,
    image_size: NDArray[np.int64],
    intrinsics: NDArray[np.float64],
) -> None:
    """Raises InvalidInput, naming the document and the key.

    frame: N, numbers in the footage; image_size: width, height; intrinsics: 3 x 3, pixels.
    """
    if frame[0] < 1 or (frame[1:] <= frame[:-1]).any():
        raise InvalidInput(f"{what} frame must count upwards from 1 or later")
    if frame[-1] > LAST_FRAME:
        raise InvalidInput(f"{what} frame ends at {frame[-1]}, beyond {LAST_FRAME}")
    check_rate(f"{what} fps", fps)
    check_size(f"{what} image_size", image_size)
    if not is_pinhole(intrinsics):
        raise InvalidInput(f"{what} intrinsics is not a pinhole camera matrix")


def check_size(what: str, size: NDArray[np.int64]) -> None:
    """Raises InvalidInput unless width and height are those of a picture."""
    if (size < 1).any() or (size > LARGEST_SIDE).any():
        raise InvalidInput(f"{what} is {size.tolist()}")
