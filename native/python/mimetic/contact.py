# SPDX-License-Identifier: GPL-3.0-or-later
"""Lips rest on each other and lids on each other: contact without friction, for shapes at rest.

Modes add up linearly and know nothing of each other, so that lips that are pressed together would
pass through each other. `Contact.relieve` finds the smallest forces between them that part them
again (a linear complementarity problem on the skin's own compliance) and lets the skin yield to
them. Forces are vertical: across the slits of a head that stands upright. Metres, head frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic.anatomy import SIDES, AttachedSkin
from mimetic.skin_mesh import SkinMesh, multiply

LIP_DEPTH = 0.008  # along the skin from the edge where lips can touch, m on the template
HALF_LIP = 0.040  # along the skin from the middle of a lip to its corners
DEEPEST = 0.012  # what lies deeper in the other lip has come from elsewhere
CORNER_GAP = 0.0015  # next to the corners lips are one skin
ROUNDS = 6  # of finding what touches and parting it
SWEEPS = 300
TOLERANCE = 2e-5
SOFTNESS = 1e-3  # of the mean compliance, added: rows of close vertices are nearly the same
BLOCK = 64  # columns solved at once


@dataclass(frozen=True)
class Slit:
    """Two rims that can touch: refined vertices, and what is a surface of each."""

    upper: NDArray[np.int64]
    lower: NDArray[np.int64]
    triangles: NDArray[np.int32] | None  # T x 3 of both lips; none for lids, whose rims are lines


class Contact:
    """What lips and lids of a person do to each other.

    skin: of `anatomy.attach_skin`.
    """

    def __init__(self, skin: AttachedSkin):
        self.skin = skin
        self.slits = [lip_slit(skin.mesh), *(lid_slit(skin.mesh, side) for side in SIDES)]
        self.vertices = np.concatenate([np.concatenate([s.upper, s.lower]) for s in self.slits])
        self.number = np.full(len(skin.mesh.vertices), -1)
        self.number[self.vertices] = np.arange(len(self.vertices))
        indptr, indices, weights = skin.mesh.stencils
        rows = [slice(indptr[v], indptr[v + 1]) for v in self.vertices]
        self.columns = np.unique(np.concatenate([indices[row] for row in rows]))
        self.stencils = np.zeros((len(rows), len(self.columns)))
        for i, row in enumerate(rows):
            self.stencils[i, np.searchsorted(self.columns, indices[row])] = weights[row]
        self.compliance = self._compliance()

    def _compliance(self) -> NDArray[np.float64]:
        """C x C, m/N: vertical motion of the vertices that can touch under vertical forces."""
        blocks = []
        for start in range(0, len(self.vertices), BLOCK):
            unit = np.eye(len(self.vertices))[start : start + BLOCK]
            blocks.append(self.stencils @ self._response(unit)[:, self.columns, 1].T)
        return np.concatenate(blocks, axis=1)

    def _response(self, upwards: NDArray[np.float64]) -> NDArray[np.float64]:
        """K x S x 3: the skin's control vertices under K x C newtons."""
        forces = np.zeros((3 * len(self.skin.mesh.vertices), len(upwards)), order="F")
        forces[3 * self.vertices + 1] = upwards.T
        solution = self.skin.model.solve(forces).T.reshape(len(upwards), -1, 3)
        response = np.zeros((len(upwards), len(self.skin.free), 3))
        response[:, self.skin.free] = solution
        return response

    def relieve(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """The displacement, V x 3, with lips and lids parted; unchanged where nothing touches."""
        forces = np.zeros(len(self.vertices))
        relieved = displacement
        for _ in range(ROUNDS):
            rows, gaps = self.overlaps(relieved)
            if not len(gaps) or gaps.min() > -TOLERANCE:
                break
            forces = forces + rows.T @ part(rows @ self.compliance @ rows.T, gaps)
            relieved = displacement + self.skin.spread(self._response(forces[None]))[0]
        return relieved

    def overlaps(self, displacement) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Rows K x C that make gaps of vertical motions, and gaps K (m, negative: overlap)."""
        count = int(self.skin.mesh.template.num_skin_vertices)
        moved = multiply(self.skin.mesh.stencils, np.asarray(displacement)[:count])
        shape = self.skin.mesh.vertices + moved
        found = [
            self._rows(*(lip_gaps if slit.triangles is not None else lid_gaps)(slit, shape))
            for slit in self.slits
        ]
        return np.concatenate([f[0] for f in found]), np.concatenate([f[1] for f in found])

    def _rows(self, vertex, against, weights, sign, gaps):
        rows = np.zeros((len(vertex), len(self.vertices)))
        at = np.arange(len(vertex))
        rows[at, self.number[vertex]] = sign
        for corner in range(against.shape[1]):
            np.add.at(rows, (at, self.number[against[:, corner]]), -sign * weights[:, corner])
        return rows, gaps


def part(compliance: NDArray[np.float64], gaps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Forces f >= 0 with compliance @ f + gaps >= 0 and f at work only where that is 0.

    By projected Gauss-Seidel.
    """
    diagonal = np.diag(compliance).copy()
    softness = SOFTNESS * diagonal.mean()
    forces = np.zeros(len(gaps))
    for _ in range(SWEEPS):
        before = forces.copy()
        for i in range(len(gaps)):
            rest = compliance[i] @ forces + gaps[i] + softness * forces[i]
            forces[i] = max(0.0, forces[i] - rest / (diagonal[i] + softness))
        if np.abs(forces - before).max() <= 1e-4 * np.abs(forces).max():
            break
    return forces


def lip_slit(mesh: SkinMesh) -> Slit:
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
    return Slit(np.flatnonzero(upper & used), np.flatnonzero(lower & used), mesh.triangles[both])


def lid_slit(mesh: SkinMesh, side: str) -> Slit:
    """The rims of one eye's lids, without the corners that they share."""
    chosen = mesh.vertices_between("skin", "eye_socket")
    margin = chosen[(mesh.vertices[chosen, 0] > 0) == (side == "L")]
    inner, outer = (mesh.vertices[mesh.landmark(f"eye_{end}.{side}")] for end in ("inner", "outer"))
    points = mesh.vertices[margin]
    chord = np.interp(np.abs(points[:, 0]), np.abs([inner[0], outer[0]]), [inner[1], outer[1]])
    aside = np.minimum(np.abs(points[:, 0] - inner[0]), np.abs(points[:, 0] - outer[0]))
    inside = aside > CORNER_GAP
    return Slit(
        margin[inside & (points[:, 1] > chord)], margin[inside & (points[:, 1] <= chord)], None
    )


def lip_gaps(slit: Slit, shape: NDArray[np.float64]):
    """What lies over or under the other lip: vertex, triangle, weights, sign, gap in height."""
    a, b, c = (shape[slit.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    is_upper = np.isin(slit.triangles[:, 0], slit.upper)
    found = []
    for own, sign, faces in (
        (slit.upper, 1.0, ~is_upper & (normal[:, 1] > 0)),
        (slit.lower, -1.0, is_upper & (normal[:, 1] < 0)),
    ):
        face, weights = faces_at(shape[own][:, [0, 2]], *(p[faces][:, [0, 2]] for p in (a, b, c)))
        hit = face >= 0
        against = slit.triangles[faces][face[hit]]
        height = (weights[hit] * shape[against][..., 1]).sum(axis=1)
        gaps = sign * (shape[own[hit], 1] - height)
        close = (gaps < 0) & (gaps > -DEEPEST)
        found.append((own[hit][close], against[close], weights[hit][close], gaps[close]))
    signs = np.repeat([1.0, -1.0], [len(f[0]) for f in found])
    vertex, against, weights, gaps = (np.concatenate(arrays) for arrays in zip(*found, strict=True))
    return vertex, against, weights, signs, gaps


def faces_at(points, a, b, c) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """In the plane: which triangle holds each point (K; -1 for none), and its weights K x 3."""

    def doubled(p, q, r):
        return (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (
            r[..., 0] - p[..., 0]
        )

    point = points[:, None]
    whole = doubled(a, b, c)
    whole = np.where(np.abs(whole) < 1e-15, np.nan, whole)
    parts = [doubled(point, b, c), doubled(a, point, c), doubled(a, b, point)]
    weights = np.stack(parts, axis=-1) / whole[..., None]
    inside = (weights >= -1e-9).all(axis=-1)
    face = np.where(inside.any(axis=1), inside.argmax(axis=1), -1)
    return face, weights[np.arange(len(points)), np.maximum(face, 0)]


def lid_gaps(slit: Slit, shape: NDArray[np.float64]):
    """As `lip_gaps`; the lower rim is a line by x, of which two vertices hold each place."""
    lower = slit.lower[np.argsort(shape[slit.lower, 0])]
    x = shape[slit.upper, 0]
    after = np.clip(np.searchsorted(shape[lower, 0], x), 1, len(lower) - 1)
    against = np.column_stack([lower[after - 1], lower[after]])
    start, end = shape[against[:, 0], 0], shape[against[:, 1], 0]
    share = np.clip((x - start) / np.maximum(end - start, 1e-9), 0, 1)
    weights = np.column_stack([1 - share, share])
    gaps = shape[slit.upper, 1] - (weights * shape[against, 1]).sum(axis=1)
    touching = gaps < 0
    chosen = slit.upper[touching], against[touching], weights[touching]
    return *chosen, np.ones(touching.sum()), gaps[touching]
