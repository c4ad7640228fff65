# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of templates to values of muscles and articulators, by what was taught."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.gaze import value_units
from mimetic.puppet.parts import FACE, PARTS
from mimetic.puppet.templates import TaughtSet

MODES = ("parts", "face")
BASES = ("linear", "gaussian")
UNTAUGHT_STD = 0.3  # of what no example moves: an activation's prior


class State(NamedTuple):
    values: NDArray[np.float64]  # C
    std: NDArray[np.float64]  # C


@dataclass
class _Region:
    templates: list[int]
    channels: list[int]
    interpolation: _core.Interpolation


class Mapping:
    """mode: `parts`, each by its own templates; `face`, by templates of the whole face, and within
    the convex hull of the looks. Raises InvalidInput where the set has no such templates.
    """

    def __init__(self, taught: TaughtSet, mode: str = "parts", basis: str = "linear") -> None:
        if mode not in MODES or basis not in BASES:
            raise InvalidInput(f"mode {mode!r}, basis {basis!r}: there are {MODES} and {BASES}")
        self.taught, self.mode = taught, mode
        self.units = value_units(taught.channels)
        options = _core.InterpolationOptions()
        options.basis = getattr(_core.Basis, basis)
        self.neutral_shift = np.zeros(len(taught.template_parts))
        self.regions = [
            region
            for part in (PARTS if mode == "parts" else (FACE,))
            if (region := self._region(part, options)) is not None
        ]
        if not self.regions:
            raise InvalidInput(
                f"the taught set has no templates for the mode {mode!r}: teach again, or choose "
                f"--mode {MODES[1 - MODES.index(mode)]}"
            )

    def _region(self, part: str, options: _core.InterpolationOptions) -> _Region | None:
        taught = self.taught
        templates = taught.of_part(part)
        channels = taught.channels_of(part)
        if not templates or not channels:
            return None
        lower, upper = taught.limits[:, channels]
        return _Region(
            templates,
            channels,
            _core.Interpolation(
                np.ascontiguousarray(taught.example_scores[:, templates]),
                np.ascontiguousarray(taught.example_values[:, channels]),
                np.ascontiguousarray(lower),
                np.ascontiguousarray(upper),
                options,
            ),
        )

    def set_neutral(self, scores: NDArray[np.float64]) -> None:
        """Takes scores (T) that are seen now as those of the face at rest: other light."""
        taught = self.taught
        off = (taught.example_values - taught.look_values[taught.neutral]) / self.units
        distance = np.abs(off).sum(axis=1)
        self.neutral_shift = taught.example_scores[int(distance.argmin())] - scores

    def state(self, scores: NDArray[np.float64]) -> State:
        """Of scores (T); what no template sees stays as in the look at rest."""
        taught = self.taught
        scores = scores + self.neutral_shift
        values = taught.look_values[taught.neutral].copy()
        std = np.full(len(values), UNTAUGHT_STD)
        for region in self.regions:
            own = np.ascontiguousarray(scores[region.templates])
            values[region.channels] = region.interpolation.state(own)
            std[region.channels] = region.interpolation.std(own)
        if self.mode == "face":
            weights = _core.hull_weights(taught.look_values / self.units, values / self.units)
            inside = weights @ taught.look_values
            std = np.hypot(std, inside - values)
            values = inside
        return State(values, std)
