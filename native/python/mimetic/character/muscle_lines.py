# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles as lines on a person's skin, from the bone to the insertion (paper, Fig. 4b).

Lines lie on the limit surface of the head's mesh and follow it: their insertion goes with the
skin, their origin with the bone under it. Metres, head frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import (
    SIDES,
    AnatomyPerturbation,
    canonical_skin,
    muscle_table,
    place_muscles,
)
from mimetic.muscles.articulators import JAW, Jaw
from mimetic.skin.closest_points import closest_weights, nearest, triangles_around
from mimetic.skin.mesh import SkinMesh

NUM_STEPS = 14  # points of a line
FIBRE_SPACING = 0.006  # of a sheet
RING_RADII = (0.6, 1.6)  # of a sphincter's fibres, in its widths
LIFT = 0.0012  # over the skin, so that the skin does not hide the line


@dataclass(frozen=True)
class SkinPoints:
    """P points on the skin's triangles."""

    corners: NDArray[np.int32]  # P x 3 refined vertices
    weights: NDArray[np.float64]  # P x 3, sum to 1

    def positions(self, vertices: NDArray[np.float64], lift: float = 0.0) -> NDArray[np.float64]:
        """P x 3 on a shape of the refined skin (N x 3), lifted outwards."""
        a, b, c = (vertices[self.corners[:, k]] for k in range(3))
        outwards = np.cross(b - a, c - a)
        outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-12)
        return np.einsum("pk,pkx->px", self.weights, np.stack([a, b, c], axis=1)) + lift * outwards


class MuscleLines:
    """The lines of all muscles on a neutral head's skin.

    names, groups: of the M muscles; muscle: L, which muscle each line belongs to. Every line has
    NUM_STEPS points, its origin first.
    """

    def __init__(self, mesh: SkinMesh):
        self._mesh = mesh
        placed = place_muscles(canonical_skin(mesh.template), self._mesh, AnatomyPerturbation())
        self.names = [f"{row['name']}.{side}" for row in muscle_table() for side in SIDES]
        self.groups = np.repeat([row["group"] for row in muscle_table()], 2)
        fibres = [_fibres(muscle) for muscle in placed]
        self.muscle = np.repeat(np.arange(len(placed)), [len(lines) for lines in fibres])
        self._skin = find_on_skin(self._mesh, np.concatenate(fibres).reshape(-1, 3))
        # A ring has no bone: all of it is skin
        on_skin = np.linspace(0, 1, NUM_STEPS)
        is_ring = [muscle.type == _core.MuscleType.sphincter for muscle in placed]
        share = np.where(np.array(is_ring)[self.muscle, None], 1.0, on_skin[None])
        self._on_skin = share.reshape(-1, 1)
        nodes = [_insertions(muscle) for muscle in placed]
        self.node_muscle = np.repeat(np.arange(len(placed)), [len(points) for points in nodes])
        self._nodes = find_on_skin(self._mesh, np.concatenate(nodes))

    @cached_property
    def _rest(self) -> NDArray[np.float64]:
        return self._skin.positions(self._mesh.vertices, LIFT)

    @cached_property
    def _bone_modes(self) -> NDArray[np.float64]:
        """3 x P x 3: how the bone under each point goes with the jaw, at value 1."""
        jaw = Jaw(self._mesh)
        influence = np.einsum("pk,pk->p", jaw.influence[self._skin.corners], self._skin.weights)
        return np.stack([influence[:, None] * jaw.motion(name, self._rest) for name in JAW])

    def positions(
        self, refined_vertices: NDArray[np.float64], jaw_values: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """L x NUM_STEPS x 3 for a shape of the refined skin (N x 3), jaw opened by values (3)."""
        skin = self._skin.positions(refined_vertices, LIFT)
        bone = self._rest + np.einsum("j,jpx->px", jaw_values, self._bone_modes)
        return (bone + self._on_skin * (skin - bone)).reshape(-1, NUM_STEPS, 3)

    def node_positions(self, refined_vertices: NDArray[np.float64]) -> NDArray[np.float64]:
        """Insertions, one row for each of `node_muscle`."""
        return self._nodes.positions(refined_vertices, LIFT)


def find_on_skin(mesh: SkinMesh, points: NDArray[np.float64]) -> SkinPoints:
    """The points of the outer skin that are nearest to the given ones (P x 3)."""
    triangles = mesh.triangles[mesh.triangle_part == "skin"]
    around = triangles_around(triangles, len(mesh.vertices))
    outer = np.unique(triangles)
    candidates = triangles[around[outer[nearest(points, mesh.vertices[outer])]]]  # P x K x 3
    weights = closest_weights(points[:, None], mesh.vertices[candidates])
    found = np.einsum("pkc,pkcx->pkx", weights, mesh.vertices[candidates])
    best = np.argmin(np.linalg.norm(found - points[:, None], axis=2), axis=1)
    rows = np.arange(len(points))
    return SkinPoints(candidates[rows, best], weights[rows, best])


def _fibres(muscle: _core.Muscle) -> NDArray[np.float64]:
    """Straight fibres or half rings in space, each NUM_STEPS x 3, before they are laid on skin."""
    if muscle.type == _core.MuscleType.sphincter:
        return _half_rings(muscle)
    ends = _insertions(muscle)
    starts = muscle.origin + ends - ends.mean(axis=0)  # a sheet's fibres are parallel
    along = np.linspace(0, 1, NUM_STEPS)[:, None]
    return starts[:, None] + along * (ends - starts)[:, None]


def _insertions(muscle: _core.Muscle) -> NDArray[np.float64]:
    """Where fibres end in the skin: a point, points along a sheet's edge, a ring's focus."""
    if muscle.type != _core.MuscleType.sheet:
        return muscle.insertion[:1]
    steps = np.linalg.norm(np.diff(muscle.insertion, axis=0), axis=1)
    length = np.concatenate([[0], np.cumsum(steps)])
    wanted = np.linspace(0, length[-1], 2 + int(length[-1] / FIBRE_SPACING))
    return np.column_stack([np.interp(wanted, length, axis) for axis in muscle.insertion.T])


def _half_rings(muscle: _core.Muscle) -> NDArray[np.float64]:
    """Ellipses about the foci, the half on the muscle's own side."""
    own, other = muscle.insertion
    centre, focal = (own + other) / 2, np.linalg.norm(own - other) / 2
    aside = (own - centre) / focal
    up = np.array([0.0, 1.0, 0.0]) - aside[1] * aside
    up /= np.linalg.norm(up)
    angle = np.linspace(-np.pi / 2, np.pi / 2, NUM_STEPS)[:, None]
    rings = []
    for minor in np.array(RING_RADII) * muscle.width:
        major = np.hypot(focal, minor)
        rings.append(centre + major * np.cos(angle) * aside + minor * np.sin(angle) * up)
    return np.stack(rings)
