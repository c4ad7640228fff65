# SPDX-License-Identifier: GPL-3.0-or-later
"""How a person's modes change with what holds the skin and where muscles are attached to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic.muscles.anatomy import (
    SIDES,
    AttachedSkin,
    canonical_skin,
    measured_place,
    muscle_names,
    muscle_table,
    place_muscle,
    pull,
    strength,
)
from mimetic.muscles.articulators import ARTICULATORS, JAW, EyeLids, Jaw, eye_frames
from mimetic.muscles.calibration import Calibration, region_weights
from mimetic.skin.mesh import SkinMesh, multiply

Floats = NDArray[np.float64]
INSERTION_STEP = 1.0  # mm, for differences: footprints are ten times as wide


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
        self.canonical = canonical_skin(mesh.template)
        self.names = muscle_names()
        self.rows = [(row, side) for row in muscle_table() for side in SIDES]
        self.articulators = tuple(ARTICULATORS)
        jaw = Jaw(mesh)
        self.bone = np.stack([jaw.under_skin(name) for name in JAW])
        lids = [lid for frame in eye_frames(mesh) for lid in EyeLids(frame).modes()]
        self.lids = np.stack(lids)[:, : int(mesh.template.num_skin_vertices)]
        self.regions = region_weights(mesh)
        self.measured = [measured_place(self.canonical, *row) for row in self.rows]

    def evaluate(self, calibration: Calibration, moved: Sequence[int] = ()) -> ResponsiveModes:
        """Modes and derivatives, those by insertion for the muscles `moved`; one factorisation."""
        skin = AttachedSkin(self.mesh, 1.0, calibration)
        muscles = pull(skin, self.canonical)
        pulled, count = muscles.responses, len(muscles.responses)
        by_jaw = np.stack([skin.model.foundation_forces(motion) for motion in self.bone])
        raw = np.concatenate([pulled, skin.respond(by_jaw)])
        scale = np.concatenate([muscles.strengths, np.ones(len(self.bone))])[:, None, None]
        # K du / d log factor = K_region (feet - u), K_region the region's share of the attachment.
        feet = np.concatenate([np.zeros((count, *self.bone.shape[1:])), self.bone])
        held = self._held(skin, raw, feet)
        by_stiffness = []
        for share in self.regions.T:
            change = skin.respond(share[:, None] * held)
            change[:count] += self._gains(pulled, change)[:, None, None] * pulled
            by_stiffness.append(np.concatenate([change * scale, np.zeros_like(self.lids)]))
        modes = np.concatenate([raw * scale, self.lids])
        by_insertion = np.zeros((2, *modes.shape))
        if len(moved) > 0:
            by_insertion[:, list(moved)] = self._by_insertion(skin, moved)
        return ResponsiveModes(modes, np.stack(by_stiffness), by_insertion)

    def _held(self, skin: AttachedSkin, raw: Floats, feet: Floats) -> Floats:
        """M x N x 3: forces of the attachment on the skin, whose feet have moved too."""
        moved = multiply(self.mesh.stencils, raw.transpose(1, 0, 2))
        stretched = np.ascontiguousarray(feet - moved.transpose(1, 0, 2))
        return np.stack([skin.model.foundation_forces(one) for one in stretched])

    def _by_insertion(self, skin: AttachedSkin, moved: Sequence[int]) -> Floats:
        """2 x (moved) x S x 3, central differences of the modes."""
        shifts = skin.calibration.insertion_shifts(self.names)
        factors = skin.calibration.strength_factors(self.names)[list(moved)]
        modes = []
        for step in INSERTION_STEP * np.array([[1, 0], [-1, 0], [0, 1], [0, -1]]):
            forces = [self._forces(i, shifts[i] + step) for i in moved]
            response = skin.respond(np.stack(forces))
            strengths = factors * [
                strength(self.rows[i][0], self.measured[i], self.mesh, one)
                for one, i in zip(response, moved, strict=True)
            ]
            modes.append(response * strengths[:, None, None])
        across = modes[0] - modes[1], modes[2] - modes[3]
        return np.stack(across) / (2 * INSERTION_STEP)

    def _forces(self, muscle: int, shift: Floats) -> Floats:
        placed = place_muscle(self.canonical, self.mesh, *self.rows[muscle], shift)
        return self.mesh.surface.forces(placed)

    def _gains(self, pulled: Floats, change: Floats) -> Floats:
        """Relative change of the strengths, so that excursions stay as the responses change."""
        gains = []
        for i, place in enumerate(self.measured):
            at = place.on_vertex(self.mesh, pulled[i])
            gains.append(-(at @ place.on_vertex(self.mesh, change[i])) / (at @ at))
        return np.array(gains)
