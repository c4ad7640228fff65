# SPDX-License-Identifier: GPL-3.0-or-later
"""Lips rest on each other and lids on each other: contact without friction, for shapes at rest.

Modes add up linearly and know nothing of each other, so that lips that are pressed together would
pass through each other. `Contact` finds the smallest forces between them that part them again (a
linear complementarity problem on the skin's own compliance, condensed to the points that can touch)
and lets the skin yield to them. Forces are vertical: across the slits of a head that stands
upright. Metres, head frame.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.anatomy import SIDES, AttachedSkin, attach_skin
from mimetic.face_template import load_template
from mimetic.skin_mesh import Csr, SkinMesh, multiply

LIP_DEPTH = 0.008  # along the skin from the edge where lips can touch, m on the template
HALF_LIP = 0.040  # along the skin from the middle of a lip to its corners
CORNER_GAP = 0.0015  # next to the corners of the eye lids are one skin
BLOCK = 64  # responses solved at once
KEPT = 4  # heads in memory, some 20 MB each
NOTICED = 0.002  # of where a force acts; what moves less is left where it is


@dataclass(frozen=True)
class TouchPoints:
    """Points of the skin that can touch.

    rest: C x 3; stencils: C x B, what a point is of the skin's B base vertices; slits: numbers of
    points.
    """

    rest: NDArray[np.float64]
    stencils: Csr
    slits: list[_core.Slit]


class Contact:
    """What lips and lids of a head do to each other.

    touch: the points that can; lift: base vertices (K) -> displacements K x B x 3 of the skin under
    one newton upwards on each; spread: from the skin to the whole head, K x B x 3 -> K x V x 3;
    read: B, a vertex of the whole head that is each base vertex.
    `vertices`: those of the head that are looked at; `moved`: those that yield.
    """

    def __init__(
        self,
        touch: TouchPoints,
        lift: Callable[[NDArray[np.int64]], NDArray[np.float64]],
        spread: Callable[[NDArray[np.float64]], NDArray[np.float64]],
        read: NDArray[np.int64],
    ):
        self.touch = touch
        indptr, indices, weights = touch.stencils
        used, column = np.unique(indices, return_inverse=True)
        self._stencils = indptr, column, weights
        self.vertices = read[used]
        dense = np.zeros((len(touch.rest), len(used)), np.float32)
        row = np.repeat(np.arange(len(touch.rest)), np.diff(indptr))
        np.add.at(dense, (row, column), weights.astype(np.float32))
        whole, points = [], []
        for start in range(0, len(used), BLOCK):
            response = lift(used[start : start + BLOCK])
            whole.append(spread(response).astype(np.float32))
            points.append(np.einsum("ck,mkx->mcx", dense, response[:, used], optimize=True))
        whole = np.concatenate(whole)
        moved = np.abs(whole).max(axis=2)
        moved /= np.maximum(moved.max(axis=1, keepdims=True), 1e-30)
        self.moved = np.flatnonzero(moved.max(axis=0) > NOTICED)
        self._response = np.ascontiguousarray(whole[:, self.moved]).reshape(len(used), -1)
        points = np.concatenate(points).astype(np.float32).reshape(len(used), -1)
        self._solver = _core.ContactSolver(touch.rest, touch.slits, dense @ points)

    def correction(self, displacement: ArrayLike) -> NDArray[np.float32] | None:
        """Displacement of `moved` (W x 3) that parts lips and lids; None if nothing touches.

        displacement: K x 3, of `vertices`.
        """
        forces = self._solver.solve(self._of_points(displacement))
        if not forces.any():
            return None
        indptr, column, weights = self._stencils
        each = weights * np.repeat(forces, np.diff(indptr))
        loads = np.bincount(column, each, len(self.vertices)).astype(np.float32)
        return (loads @ self._response).reshape(-1, 3)

    def relieve(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """The displacement, V x 3, with lips and lids parted; unchanged where nothing touches."""
        correction = self.correction(displacement[self.vertices])
        if correction is None:
            return displacement
        relieved = np.array(displacement, dtype=np.float64)
        relieved[self.moved] += correction
        return relieved

    def gaps(self, displacement: ArrayLike) -> NDArray[np.float64]:
        """Gaps of what overlaps at a displacement (V x 3), all negative."""
        return self._solver.gaps(self._of_points(np.asarray(displacement)[self.vertices]))

    def depth(self, displacement: ArrayLike) -> float:
        """How deep lips or lids lie in each other, metres."""
        return -float(self.gaps(displacement).min(initial=0.0))

    def _of_points(self, displacement: ArrayLike) -> NDArray[np.float64]:
        return multiply(self._stencils, np.asarray(displacement, dtype=np.float64))


def contact_on(neutral: NDArray[np.float64]) -> Contact:
    """The contact of a head of the template's mesh at rest (V x 3), made once for heads that are
    alike to single precision. Raises InvalidInput as `anatomy.attach_skin` does; its warnings are
    for who makes the head and are left out."""
    return _contact_on(np.ascontiguousarray(neutral, dtype=np.float32).tobytes())


@lru_cache(maxsize=KEPT)
def _contact_on(neutral: bytes) -> Contact:
    vertices = np.frombuffer(neutral, dtype=np.float32).reshape(-1, 3).astype(np.float64)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return attach_contact(attach_skin(vertices, load_template()))


def attach_contact(skin: AttachedSkin) -> Contact:
    """Contact on a person whose skin is attached (`anatomy.attach_skin`)."""
    mesh, model = skin.mesh, skin.model
    number = np.cumsum(skin.free) - 1

    def lift(vertices: NDArray[np.int64]) -> NDArray[np.float64]:
        chosen = skin.free[vertices]  # what is held does not move, whatever lifts it
        loads = np.zeros((3 * int(skin.free.sum()), len(vertices)), order="F")
        loads[3 * number[vertices[chosen]] + 1, np.flatnonzero(chosen)] = 1
        response = np.zeros((len(vertices), len(skin.free), 3))
        solved = model.solve_loads(loads).T.reshape(len(vertices), -1, 3)
        response[:, skin.free] = solved
        return response

    return Contact(touch_points(mesh), lift, skin.spread, np.arange(len(skin.free)))


def touch_points(mesh: SkinMesh) -> TouchPoints:
    """Lips and rims of the lids: vertices of the refined skin."""
    slits = [lip_slit(mesh), *(lid_slit(mesh, side) for side in SIDES)]
    vertices = np.concatenate([np.concatenate([slit.upper, slit.lower]) for slit in slits])
    number = np.full(len(mesh.vertices), -1)
    number[vertices] = np.arange(len(vertices))
    slits = [
        _core.Slit(number[s.upper], number[s.lower], number[s.triangles].astype(np.int32))
        for s in slits
    ]
    indptr, indices, weights = mesh.stencils
    counts = np.diff(indptr)[vertices]
    entries = np.repeat(indptr[vertices] - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    entries = entries + np.arange(counts.sum())
    stencils = np.concatenate([[0], np.cumsum(counts)]), indices[entries], weights[entries]
    return TouchPoints(np.ascontiguousarray(mesh.vertices[vertices]), stencils, slits)


def lip_slit(mesh: SkinMesh) -> _core.Slit:
    """The two lips as far as they can touch, the mouth's lining behind them included."""
    margin = mesh.vertices[mesh.vertices_between("skin", "mouth_cavity")]
    near = np.isfinite(mesh.whole_surface.distances(margin, LIP_DEPTH * mesh.size))
    reach = [
        mesh.whole_surface.distances(
            mesh.vertices[[mesh.landmark(f"lip_{lip}_inner")]], HALF_LIP * mesh.size
        )
        for lip in ("upper", "lower")
    ]
    upper = near & (reach[0] < reach[1])
    lower = near & (reach[1] < reach[0])
    both = upper[mesh.triangles].all(axis=1) | lower[mesh.triangles].all(axis=1)
    used = np.zeros(len(upper), bool)
    used[mesh.triangles[both]] = True
    return _core.Slit(
        np.flatnonzero(upper & used), np.flatnonzero(lower & used), mesh.triangles[both]
    )


def lid_slit(mesh: SkinMesh, side: str) -> _core.Slit:
    """The rims of one eye's lids, without the corners that they share."""
    chosen = mesh.vertices_between("skin", "eye_socket")
    margin = chosen[(mesh.vertices[chosen, 0] > 0) == (side == "L")]
    inner, outer = (mesh.vertices[mesh.landmark(f"eye_{end}.{side}")] for end in ("inner", "outer"))
    points = mesh.vertices[margin]
    chord = np.interp(np.abs(points[:, 0]), np.abs([inner[0], outer[0]]), [inner[1], outer[1]])
    aside = np.minimum(np.abs(points[:, 0] - inner[0]), np.abs(points[:, 0] - outer[0]))
    inside = aside > CORNER_GAP * mesh.size
    return _core.Slit(
        margin[inside & (points[:, 1] > chord)], margin[inside & (points[:, 1] <= chord)]
    )
