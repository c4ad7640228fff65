# SPDX-License-Identifier: GPL-3.0-or-later
"""How a person's modes change with what holds the skin and where muscles are attached to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import material_table, muscle_entries, muscle_names
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.calibration import REGIONS, Calibration, region_weights
from mimetic.skin.mesh import SkinMesh, canonical_skin

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class ResponsiveModes:
    """Muscles (strengths included), then jaw and lids, on the skin's S control vertices.

    modes: M x S x 3, metres at the value 1; by_stiffness: R x M x S x 3, what they change with the
    logarithm of each region's factor; by_insertion: 2 x M x S x 3, with each muscle's own insertion
    away from the midline and up, a millimetre; 0 where not asked for.
    """

    modes: Floats
    by_stiffness: Floats
    by_insertion: Floats


class SkinResponse:
    """A person's muscles and jaw on the skin, for one calibration after another."""

    def __init__(self, mesh: SkinMesh):
        self.mesh = mesh
        self.names = muscle_names()
        self.articulators = tuple(ARTICULATORS)
        self._core = _core.SkinResponse(
            mesh,
            canonical_skin(mesh.template),
            muscle_entries(),
            material_table(),
            region_weights(mesh),
        )

    def evaluate(self, calibration: Calibration, muscles: Sequence[int] = ()) -> ResponsiveModes:
        """Modes and derivatives, those by insertion for `muscles`, indices; one factorisation."""
        modes, by_stiffness, by_insertion = self._core.evaluate(
            stiffness=calibration.region_factors(),
            strength=calibration.strength_factors(self.names),
            insertion_mm=calibration.insertion_shifts(self.names),
            moved=list(muscles),
        )
        return ResponsiveModes(
            modes,
            by_stiffness.reshape(len(REGIONS), *modes.shape),
            by_insertion.reshape(2, *modes.shape),
        )
