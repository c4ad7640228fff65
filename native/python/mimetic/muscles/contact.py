# SPDX-License-Identifier: GPL-3.0-or-later
"""Lips rest on each other and lids on each other: contact without friction, for shapes at rest.

Modes add up linearly and know nothing of each other, so that lips that are pressed together would
pass through each other. `Contact` finds the smallest forces between them that part them again (a
linear complementarity problem on the skin's own compliance, condensed to the points that can touch)
and lets the skin yield to them. Forces are vertical: across the slits of a head that stands
upright. Lids slide on the eye: what would sink into it is put back to its distance from the eye's
centre. Metres, head frame.
"""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.muscles.anatomy import SIDES, AttachedSkin, attach_skin
from mimetic.muscles.articulators import LID_REACH, EyeFrame, eye_frames, smooth_step
from mimetic.skin.mesh import Csr, SkinMesh, multiply, split_quads
from mimetic.template.face_template import load_template

LIP_DEPTH = 0.008  # along the skin from the edge where lips can touch, m on the template
HALF_LIP = 0.040  # along the skin from the middle of a lip to its corners
CORNER_GAP = 0.0015  # next to the corners of the eye lids are one skin
BLOCK = 64  # responses solved at once
SINK = 0.0006  # m; at half closure a lid's chord lies so deep inside its arc, still on the eye
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


@dataclass(frozen=True)
class EyeRest:
    """Skin that lies on an eye: base vertices (E), their places at rest, and how much of sinking
    into the eye is put back, 1 at the margin of the lids."""

    centre: NDArray[np.float64]
    vertices: NDArray[np.int64]
    rest: NDArray[np.float64]  # E x 3
    share: NDArray[np.float64]  # E
    sink: float  # m, that is left alone

    def push(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """E x 3, away from the eye's centre."""
        arm = self.rest + displacement - self.centre
        length = np.linalg.norm(arm, axis=1)
        least = np.linalg.norm(self.rest - self.centre, axis=1) - self.sink
        push = self.share * np.maximum(least - length, 0) / np.maximum(length, 1e-9)
        return push[:, None] * arm


class Contact:
    """What lips and lids of a head do to each other.

    touch: the points that can; eyes: what lies on them; lift: base vertices (U) and newtons upwards
    on them (K x U) -> displacements of the skin, K x B x 3; spread: from the skin to the whole
    head, K x B x 3 -> K x V x 3; read: B, a vertex of the whole head that is each base vertex.
    `vertices`: those of the head that are looked at; `moved`: those that yield. Displacements are
    in the head frame, or in that of `turned`.
    """

    def __init__(
        self,
        touch: TouchPoints,
        eyes: list[EyeRest],
        lift: Callable[[NDArray[np.int64], NDArray], NDArray[np.float64]],
        spread: Callable[[NDArray[np.float64]], NDArray[np.float64]],
        read: NDArray[np.int64],
    ):
        self.touch = touch
        self._turn = np.eye(3)
        indptr, indices, weights = touch.stencils
        used, column = np.unique(indices, return_inverse=True)
        self._stencils = indptr, column, weights
        on_eyes = np.concatenate([eye.vertices for eye in eyes]) if eyes else np.zeros(0, np.int64)
        self._eyes, self._num_columns = eyes, len(used)
        self.vertices = read[np.concatenate([used, on_eyes])]
        dense = np.zeros((len(touch.rest), len(used)), np.float32)
        row = np.repeat(np.arange(len(touch.rest)), np.diff(indptr))
        np.add.at(dense, (row, column), weights.astype(np.float32))
        # Forces on points come down to forces on base vertices: solved are the fewer of the two
        self._by_vertex = len(used) < len(dense)
        loads = np.eye(len(used), dtype=np.float32) if self._by_vertex else dense
        whole, points = [], []
        for start in range(0, len(loads), BLOCK):
            response = lift(used, loads[start : start + BLOCK])
            whole.append(spread(response).astype(np.float32))
            points.append(np.einsum("ck,mkx->mcx", dense, response[:, used], optimize=True))
        whole = np.concatenate(whole)
        moved = np.abs(whole).max(axis=2)
        moved /= np.maximum(moved.max(axis=1, keepdims=True), 1e-30)
        is_moved = moved.max(axis=0) > NOTICED
        is_moved[read[on_eyes]] = True
        self.moved = np.flatnonzero(is_moved)
        self._on_eyes = np.searchsorted(self.moved, read[on_eyes])
        self._response = np.ascontiguousarray(whole[:, self.moved]).reshape(len(loads), -1)
        points = np.concatenate(points).astype(np.float32).reshape(len(loads), -1)
        points = dense @ points if self._by_vertex else points
        self._solver = _core.ContactSolver(touch.rest, touch.slits, points)

    def correction(self, displacement: ArrayLike) -> NDArray[np.float32] | None:
        """Displacement of `moved` (W x 3) that parts lips and lids; None if nothing touches.

        displacement: K x 3, of `vertices`.
        """
        displacement = np.asarray(displacement, dtype=np.float64) @ np.linalg.inv(self._turn).T
        columns, lids = np.split(displacement, [self._num_columns])
        pushed = self._push(lids)
        forces = self._solver.solve(multiply(self._stencils, columns))
        if not forces.any() and not pushed.any():
            return None
        correction = self._yield(forces) if forces.any() else np.zeros((len(self.moved), 3))
        correction[self._on_eyes] += self._push(lids + correction[self._on_eyes])
        return (correction @ self._turn.T).astype(np.float32)

    def _push(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Out of the eyes, of all that lies on them."""
        ends = np.cumsum([len(eye.vertices) for eye in self._eyes])[:-1]
        parts = zip(self._eyes, np.split(displacement, ends), strict=True)
        return np.concatenate([eye.push(part) for eye, part in parts] or [displacement])

    def _yield(self, forces: NDArray[np.float64]) -> NDArray[np.float32]:
        """W x 3: what the skin does under forces on the points."""
        loads = forces
        if self._by_vertex:
            indptr, column, weights = self._stencils
            each = weights * np.repeat(forces, np.diff(indptr))
            loads = np.bincount(column, each, self._num_columns)
        loads = loads.astype(np.float32)
        pushed = np.flatnonzero(loads)
        if 4 * len(pushed) < len(loads):  # few rows are read faster than all
            return (loads[pushed] @ self._response[pushed]).reshape(-1, 3)
        return (loads @ self._response).reshape(-1, 3)

    def turned(self, linear: ArrayLike) -> Contact:
        """The same contact for displacements in another frame: linear (3 x 3) @ those of this."""
        other = copy.copy(self)
        other._turn = np.asarray(linear, dtype=np.float64) @ self._turn
        return other

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
        own = np.asarray(displacement, dtype=np.float64)[self.vertices[: self._num_columns]]
        return self._solver.gaps(multiply(self._stencils, own @ np.linalg.inv(self._turn).T))

    def depth(self, displacement: ArrayLike) -> float:
        """How deep lips or lids lie in each other, metres."""
        return -float(self.gaps(displacement).min(initial=0.0))


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

    def lift(vertices: NDArray[np.int64], upwards: NDArray) -> NDArray[np.float64]:
        chosen = skin.free[vertices]  # what is held does not move, whatever lifts it
        loads = np.zeros((3 * int(skin.free.sum()), len(upwards)), order="F")
        loads[3 * number[vertices[chosen]] + 1] = upwards[:, chosen].T
        response = np.zeros((len(upwards), len(skin.free), 3))
        solved = model.solve_loads(loads).T.reshape(len(upwards), -1, 3)
        response[:, skin.free] = solved
        return response

    eyes = [eye_rest(frame) for frame in eye_frames(mesh)]
    return Contact(touch_points(mesh), eyes, lift, skin.spread, np.arange(len(skin.free)))


def eye_rest(frame: EyeFrame) -> EyeRest:
    """Lids on an eye of a head of the template's mesh, control vertices."""
    mesh, reach = frame.mesh, LID_REACH * frame.mesh.size
    count = int(mesh.template.num_skin_vertices)
    way = mesh.whole_surface.distances(mesh.vertices[frame.margin], reach)[:count]
    near = np.flatnonzero(way < reach)
    share = smooth_step(2 - 2 * way[near] / reach)
    return EyeRest(frame.centre, near, mesh.neutral[near], share, SINK * mesh.size)


def touch_points(mesh: SkinMesh) -> TouchPoints:
    """Lips and rims of the lids: vertices of the refined skin."""
    slits = [lip_slit(mesh), *(lid_slit(mesh, side) for side in SIDES)]
    vertices, slits = numbered(slits, np.ones(len(mesh.vertices), bool))
    indptr, indices, weights = mesh.stencils
    counts = np.diff(indptr)[vertices]
    entries = np.repeat(indptr[vertices] - np.concatenate([[0], np.cumsum(counts)[:-1]]), counts)
    entries = entries + np.arange(counts.sum())
    stencils = np.concatenate([[0], np.cumsum(counts)]), indices[entries], weights[entries]
    return TouchPoints(np.ascontiguousarray(mesh.vertices[vertices]), stencils, slits)


def numbered(
    slits: list[_core.Slit], kept: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], list[_core.Slit]]:
    """The slits' vertices that are kept (C), and slits by their numbers among these."""
    rims = [[np.array(rim, np.int64) for rim in (s.upper, s.lower)] for s in slits]
    rims = [[rim[kept[rim]] for rim in pair] for pair in rims]
    vertices = np.concatenate([rim for pair in rims for rim in pair])
    number = np.full(len(kept), -1)
    number[vertices] = np.arange(len(vertices))
    found = []
    for slit, (upper, lower) in zip(slits, rims, strict=True):
        triangles = number[slit.triangles]
        triangles = triangles[(triangles >= 0).all(axis=1)].astype(np.int32)
        if len(upper) and len(lower) and len(triangles) >= min(1, len(slit.triangles)):
            found.append(_core.Slit(number[upper], number[lower], triangles))
    return vertices, found


def lip_slit(mesh: SkinMesh, refined: bool = True) -> _core.Slit:
    """The two lips as far as they can touch, the mouth's lining behind them included.

    refined: all vertices of the refined skin, or those alone that are its control vertices' limits.
    """
    triangles = mesh.triangles if refined else split_quads(mesh.vertices, mesh.faces)
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
    both = upper[triangles].all(axis=1) | lower[triangles].all(axis=1)
    used = np.zeros(len(upper), bool)
    used[triangles[both]] = True
    return _core.Slit(np.flatnonzero(upper & used), np.flatnonzero(lower & used), triangles[both])


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
