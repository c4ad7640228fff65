# SPDX-License-Identifier: GPL-3.0-or-later
"""Where footage cuts to another scene."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

Images = Iterator[tuple[int, NDArray[np.uint8]]]  # with the frames' numbers
CUT_DIFFERENCE = 18.0  # mean change of grey levels from frame to frame


class CutWatch:
    """Detects where another scene starts, frame by frame."""

    def __init__(self, before: NDArray[np.uint8] | None = None) -> None:
        self._before = None if before is None else self._shrink(before)

    def starts_scene(self, image: NDArray[np.uint8]) -> bool:
        """Whether this frame (H x W x 3) is cut off from the one before."""
        small, before = self._shrink(image), self._before
        self._before = small
        return before is not None and bool(np.abs(small - before).mean() > CUT_DIFFERENCE)

    @staticmethod
    def _shrink(image: NDArray[np.uint8]) -> NDArray[np.float64]:
        """A small copy of a frame, enough to detect a cut; grey levels."""
        return image[::8, ::8].mean(axis=2)


def of_one_scene(before: NDArray[np.uint8], images: Images) -> Images:
    """The images up to a cut; before: the one that they follow."""
    cuts = CutWatch(before)
    for frame, image in images:
        if cuts.starts_scene(image):
            return
        yield frame, image
