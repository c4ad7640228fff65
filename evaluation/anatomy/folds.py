# SPDX-License-Identifier: GPL-3.0-or-later
"""How sharply a moved skin is creased: angles between neighbouring triangles that are seen.

0 is flat, 180 degrees a fold that lies on itself, as an inverted triangle among upright ones does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from mimetic.skin.mesh import SkinMesh, multiply
from numpy.typing import NDArray

FACES_FRONT = 0.1  # cosine of the normal to the front, as for the vertices seen from there


@dataclass(frozen=True)
class Folds:
    """Creases of one head's outer skin as seen from the front, P pairs of triangles."""

    mesh: SkinMesh

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        return self.mesh.triangles[self.mesh.triangle_part == "skin"]

    @cached_property
    def pairs(self) -> NDArray[np.int64]:
        """P x 2: triangles that share an edge and together face the front at rest."""
        faces = self.triangles
        edges = np.sort(np.vstack([faces[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
        owner = np.tile(np.arange(len(faces)), 3)
        order = np.lexsort(edges.T)
        repeats = np.flatnonzero((np.diff(edges[order], axis=0) == 0).all(axis=1))
        pairs = np.column_stack([owner[order][repeats], owner[order][repeats + 1]])
        return pairs[self._normals(self.mesh.vertices)[pairs].mean(axis=1)[:, 2] > FACES_FRONT]

    def angles(self, displacement: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
        """P degrees between the pairs' normals; displacement: V x 3 m, none at rest."""
        shape = self.mesh.vertices
        if displacement is not None:
            count = int(self.mesh.template.num_skin_vertices)
            shape = shape + multiply(self.mesh.stencils, np.asarray(displacement)[:count])
        normals = self._normals(shape)[self.pairs]
        cosine = (normals[:, 0] * normals[:, 1]).sum(axis=1)
        return np.degrees(np.arccos(np.clip(cosine, -1, 1)))

    def _normals(self, shape: NDArray[np.float64]) -> NDArray[np.float64]:
        a, b, c = (shape[self.triangles[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)
