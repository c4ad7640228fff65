# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's face shapes from a live state, as other programs expect them: data/arkit_shapes.toml."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mimetic.muscles.anatomy import load_table

SIDES = {"Left": "L", "Right": "R"}


@cache
def shape_names() -> tuple[str, ...]:
    """The 52, in Live Link Face's order."""
    return tuple(load_table("arkit_shapes.toml")["order"])


@cache
def shape_factors() -> dict[str, dict[str, float]]:
    """What each shape that is measured is made of: names of values, and their factors."""
    factors: dict[str, dict[str, float]] = {}
    for shape, parts in load_table("arkit_shapes.toml")["shapes"].items():
        if not shape.endswith("SIDE"):
            factors[shape] = dict(parts)
            continue
        for word, side in SIDES.items():
            factors[shape.removesuffix("SIDE") + word] = {
                name.replace("SIDE", side): factor for name, factor in parts.items()
            }
    return factors


class ArkitShapes:
    """The 52 weights of values that have these names."""

    def __init__(self, names: Sequence[str]) -> None:
        self._matrix = np.zeros((len(shape_names()), len(names)))
        for shape, parts in shape_factors().items():
            for name, factor in parts.items():
                if name in names:  # without the networks lips have no shapes of their own
                    self._matrix[shape_names().index(shape), list(names).index(name)] = factor

    def weights(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """52 from 0 to 1, in the order of `shape_names`."""
        return np.clip(self._matrix @ values, 0.0, 1.0)
