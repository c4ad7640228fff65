# SPDX-License-Identifier: GPL-3.0-or-later
"""Templates of a taught set, ready to be matched."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.puppet.parts import KINDS
from mimetic.puppet.seeing import (
    FREE_RADIUS,
    FREE_ROTATIONS,
    FREE_SCALES,
    RADIUS,
    Image,
    centres,
)


def still_matcher(
    pictures: Sequence[Image], boxes: NDArray[np.int64], parts: Sequence[str]
) -> _core.TemplateMatcher:
    """For the view, in which the head is still: each template about its own place."""
    options = _core.MatchOptions()
    options.follow = False
    options.search_radius = RADIUS
    return _core.TemplateMatcher(list(pictures), centres(boxes), groups_of(parts), options)


def free_matcher(
    pictures: Sequence[Image], places: NDArray[np.float64], parts: Sequence[str]
) -> _core.TemplateMatcher:
    """For frames as they are, scaled to the view's pixels: templates follow the face, a little
    larger or smaller and turned, as in the paper. places: T x 2, where the search begins.
    """
    options = _core.MatchOptions()
    options.search_radius = FREE_RADIUS
    options.scales = list(FREE_SCALES)
    options.rotations = list(FREE_ROTATIONS)
    return _core.TemplateMatcher(list(pictures), places, groups_of(parts), options)


def groups_of(parts: Sequence[str]) -> list[int]:
    return [KINDS.index(part) for part in parts]
