# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles as lines on a person's skin, from the bone to the insertion (paper, Fig. 4b).

Lines lie on the limit surface of the head's mesh and follow it: their insertion goes with the
skin, their origin with the bone under it. Metres, head frame.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import (
    AnatomyPerturbation,
    muscle_groups,
    muscle_names,
    place_muscles,
)
from mimetic.muscles.articulators import JAW, Jaw
from mimetic.skin.mesh import SkinMesh, canonical_skin

NUM_STEPS = 14  # points of a line
LIFT = 0.0012  # over the skin, so that the skin does not hide the line


class MuscleLines:
    """The lines of all muscles on a neutral head's skin.

    names, groups: of the M muscles; muscle: L, which muscle each line belongs to. Every line has
    NUM_STEPS points, its origin first.
    """

    def __init__(self, mesh: SkinMesh):
        self._mesh = mesh
        canonical = canonical_skin(mesh.template)
        muscles = [one.muscle for one in place_muscles(canonical, mesh, AnatomyPerturbation())]
        self.names = list(muscle_names())
        self.groups = muscle_groups()
        fibres = [_core.muscle_fibres(muscle, NUM_STEPS) for muscle in muscles]
        self.muscle = np.repeat(np.arange(len(muscles)), [len(lines) for lines in fibres])
        self._skin = find_on_skin(self._mesh, np.concatenate(fibres).reshape(-1, 3))
        # A ring has no bone: all of it is skin
        on_skin = np.linspace(0, 1, NUM_STEPS)
        is_ring = [muscle.type == _core.MuscleType.sphincter for muscle in muscles]
        share = np.where(np.array(is_ring)[self.muscle, None], 1.0, on_skin[None])
        self._on_skin = share.reshape(-1)
        nodes = [_core.insertion_nodes(muscle) for muscle in muscles]
        self.node_muscle = np.repeat(np.arange(len(muscles)), [len(points) for points in nodes])
        self._nodes = find_on_skin(self._mesh, np.concatenate(nodes))

    @cached_property
    def _lines(self) -> _core.MuscleLines:
        """With how the bone under each point goes with the jaw, at value 1."""
        rest = self._skin.positions(self._mesh.vertices, LIFT)
        jaw = Jaw(self._mesh)
        influence = self._skin.values(jaw.influence)[:, None]
        bone = np.stack([(influence * jaw.motion(name, rest)).reshape(-1) for name in JAW])
        return _core.MuscleLines(self._skin, rest, bone, self._on_skin)

    def positions(
        self, refined_vertices: NDArray[np.float64], jaw_values: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """L x NUM_STEPS x 3 for a shape of the refined skin (N x 3), jaw opened by values (3)."""
        points = self._lines.positions(refined_vertices, jaw_values, LIFT)
        return points.reshape(-1, NUM_STEPS, 3)

    def node_positions(self, refined_vertices: NDArray[np.float64]) -> NDArray[np.float64]:
        """Insertions, one row for each of `node_muscle`."""
        return self._nodes.positions(refined_vertices, LIFT)


def find_on_skin(mesh: SkinMesh, points: NDArray[np.float64]) -> _core.SkinPlaces:
    """The points of the outer skin that are nearest to the given ones (P x 3)."""
    triangles = mesh.triangles[mesh.triangle_part == "skin"]
    return _core.nearest_places(points, mesh.vertices, triangles)
