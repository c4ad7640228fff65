# SPDX-License-Identifier: GPL-3.0-or-later
"""Where footage cuts to another scene."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mimetic import _core

Image = NDArray[np.uint8]
Images = Iterator[tuple[int, Image]]  # with the frames' numbers
CUT_DIFFERENCE = 18.0  # mean change of grey levels from frame to frame
# A page that scrolls beside a face, a camera that shakes and light that jumps change as much. So a
# cut must also have changed the face's square, shifted and lit as it may be, by this share of its
# contrast. In five clips: the same face in the next frame, shaken or blurred, .05 to .35, with .6
# or 1.5 times the light, .02 to .25; another's in its place, .59 and more
UNLIKE = 0.35
FLAT = 2.0  # grey levels of contrast that noise alone has
REACH = 1 / 6  # of the square's side, that it may be shifted by
CELLS = 48  # along the square's side: as finely as it is compared
SAMPLES = 8  # of a cell's pixels along its side, at least


class CutWatch:
    """Detects where another scene starts, frame by frame; before: the one that comes before."""

    def __init__(self, before: Image | None = None) -> None:
        self._before = before
        self._small = None if before is None else self._shrink(before)

    def starts_scene(self, image: Image, face: _core.FeatureCrop | None = None) -> bool:
        """Whether this frame (H x W x 3) is cut off from the one before.

        face: where that one shows the face; without it the whole picture is looked at.
        """
        before, small_before = self._before, self._small
        self._before, self._small = image, self._shrink(image)
        if before is None or small_before is None:
            return False
        has_changed = np.abs(self._small - small_before).mean() > CUT_DIFFERENCE
        return bool(has_changed) and _is_unlike(before, image, face)

    @staticmethod
    def _shrink(image: Image) -> NDArray[np.float64]:
        """A small copy of a frame, enough to detect a cut; grey levels."""
        return image[::8, ::8].mean(axis=2)


def of_one_scene(before: Image, images: Images, face: _core.FeatureCrop | None = None) -> Images:
    """The images up to a cut; before: the one that they follow, which shows the face there."""
    cuts = CutWatch(before)
    for frame, image in images:
        if cuts.starts_scene(image, face):
            return
        yield frame, image


def _is_unlike(before: Image, image: Image, face: _core.FeatureCrop | None) -> bool:
    """Whether no small shift of the frame before shows in a face's square what the image does."""
    height, width = image.shape[:2]
    box, side = (0, 0, width, height), float(min(width, height))
    if face is not None:
        seen = _box_round(face, width, height)
        # At the picture's edge too little of it may be left to tell by
        if min(seen[2] - seen[0], seen[3] - seen[1]) > (0.5 + 2 * REACH) * face.side:
            box, side = seen, face.side
    step = max(1, round(side / (CELLS * SAMPLES)))  # pixels between samples
    cell = max(1, round(side / (CELLS * step)))  # samples
    was, now = (_cells(picture, box, step, cell) for picture in (before, image))
    reach = round(REACH * side / (cell * step))
    inner = _evenly_lit(now[reach:-reach, reach:-reach])
    rows, columns = inner.shape
    least = min(
        np.abs(_evenly_lit(was[y : y + rows, x : x + columns]) - inner).mean()
        for y, x in itertools.product(range(1 + 2 * reach), repeat=2)
    )
    return bool(least > UNLIKE)


def _evenly_lit(levels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Grey levels about their mean, in shares of their mean deviation."""
    about_mean = levels - levels.mean()
    return about_mean / (np.abs(about_mean).mean() + FLAT)


def _box_round(face: _core.FeatureCrop, width: int, height: int) -> tuple[int, int, int, int]:
    """Left, top, right, bottom of what a face's square may be shifted over, in the picture."""
    half = (0.5 + REACH) * face.side
    (left, top), (right, bottom) = face.center - half, face.center + half
    return max(0, int(left)), max(0, int(top)), min(width, int(right)), min(height, int(bottom))


def _cells(
    image: Image, box: tuple[int, int, int, int], step: int, cell: int
) -> NDArray[np.float64]:
    """Mean grey levels of squares of `cell` x `cell` samples, `step` pixels apart, in a box."""
    left, top, right, bottom = box
    samples = image[top:bottom:step, left:right:step]
    rows, columns = samples.shape[0] // cell, samples.shape[1] // cell
    samples = samples[: rows * cell, : columns * cell]
    return samples.reshape(rows, cell, columns, cell, 3).mean(axis=(1, 3, 4))
