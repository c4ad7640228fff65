# SPDX-License-Identifier: GPL-3.0-or-later
"""The skin of a person as a finite-element mesh, and places on it.

Shapes: V control vertices of the whole head, S of its skin (they come first), N vertices of the
refined skin, T triangles. Metres, head frame (x to the subject's left, y up, z out of the face).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mimetic import _core
from mimetic.skin.checks import unfold

LEVELS = 1  # forehead faces of 13-23 mm are too coarse for a muscle 8 mm wide
SCALE_REACH = 0.025  # m on the template: s.d. over which sizes are averaged, the spread of a pull
Csr = tuple[np.ndarray, np.ndarray, np.ndarray]


def multiply(matrix: Csr, values: np.ndarray) -> np.ndarray:
    """Product of compressed rows with one row of values a column."""
    indptr, indices, weights = matrix
    terms = weights.reshape(-1, *[1] * (values.ndim - 1)) * values[indices]
    filled = np.diff(indptr) > 0
    product = np.zeros((len(filled), *terms.shape[1:]))
    product[filled] = np.add.reduceat(terms, indptr[:-1][filled], axis=0)
    return product


def keep_columns(matrix: Csr, kept: np.ndarray) -> Csr:
    """The matrix without the columns where `kept` is false."""
    indptr, indices, weights = matrix
    stays = kept[indices]
    number = np.cumsum(kept) - 1
    count = np.concatenate([[0], np.cumsum(stays)])[indptr]
    return count.astype(np.int32), number[indices[stays]].astype(np.int32), weights[stays]


def split_quads(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Triangles (2F, 3), rows 2i and 2i + 1 of quad i, cut along its shorter diagonal: a mirrored
    mesh is then cut in mirrored places."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    along_ac = np.linalg.norm(a - c, axis=1) <= np.linalg.norm(b - d, axis=1)
    by_ac = quads[:, [0, 1, 2, 0, 2, 3]]
    by_bd = quads[:, [0, 1, 3, 1, 2, 3]]
    return np.where(along_ac[:, None], by_ac, by_bd).reshape(-1, 3).astype(np.int32)


def quad_normals(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Unit normals of vertices (V x 3): of the quads around each, by their areas; 0 without any."""
    across = _crossed_diagonals(vertices, quads)
    normals = np.zeros_like(vertices)
    for k in range(4):
        np.add.at(normals, quads[:, k], across)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)


def _quad_areas(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    return np.linalg.norm(_crossed_diagonals(vertices, quads), axis=1) / 2


def _crossed_diagonals(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """F x 3 along the quads' normals, twice their areas long."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    return np.cross(c - a, d - b)


@dataclass(frozen=True)
class SkinMesh:
    """A neutral head's skin, refined and cut into triangles."""

    template: object
    neutral: np.ndarray  # V x 3

    @cached_property
    def refinement(self) -> _core.SubdividedMesh:
        count = int(self.template.num_skin_vertices)
        return _core.SubdividedMesh(self.faces, count, LEVELS)

    @cached_property
    def faces(self) -> np.ndarray:
        faces = self.template.faces[: int(self.template.num_skin_faces)]
        return np.ascontiguousarray(faces, dtype=np.int32)

    @cached_property
    def stencils(self) -> Csr:
        return self.refinement.stencils()

    @cached_property
    def vertices(self) -> np.ndarray:
        """N x 3; where faces lie turned over, smoothed with a warning."""
        limit = multiply(self.stencils, self.neutral[: int(self.template.num_skin_vertices)])
        face = np.repeat(self.refinement.parent_face, 2)
        return unfold(limit, lambda v: split_quads(v, self.refinement.faces), face)

    @cached_property
    def triangles(self) -> np.ndarray:
        """T x 3 int32."""
        return split_quads(self.vertices, self.refinement.faces)

    @cached_property
    def triangle_part(self) -> np.ndarray:
        """T names of parts: skin, mouth_cavity, eye_socket."""
        names = np.asarray(self.template.part_names)
        return names[np.repeat(self.template.part[self.refinement.parent_face], 2)]

    @cached_property
    def surface(self) -> _core.MuscleSurface:
        """The outer skin, on which muscles act and distances run."""
        return _core.MuscleSurface(self.vertices, self.triangles, self.triangle_part == "skin")

    @cached_property
    def whole_surface(self) -> _core.MuscleSurface:
        """The outer skin with mouth cavity and eye sockets."""
        return _core.MuscleSurface(
            self.vertices, self.triangles, np.ones(len(self.triangles), bool)
        )

    @cached_property
    def normals(self) -> np.ndarray:
        """N x 3, unit."""
        return self.refinement.normals(self.neutral[: int(self.template.num_skin_vertices)])

    @cached_property
    def seen_from_front(self) -> np.ndarray:
        """Refined vertices of the outer skin that do not face backwards."""
        outer = np.unique(self.triangles[self.triangle_part == "skin"])
        return outer[self.normals[outer, 2] > 0.1]

    @cached_property
    def local_scale(self) -> np.ndarray:
        """S: how many times as long as the template's this person's skin is, around each vertex.

        Square root of the areas' ratio, averaged with a Gaussian of SCALE_REACH over the template.
        """
        quads, own, usual = self._outer_areas
        canonical = np.asarray(self.template.vertices)
        middles = canonical[quads].mean(axis=1)
        scale = np.empty(int(self.template.num_skin_vertices))
        for start in range(0, len(scale), 512):  # a block at a time: memory stays small
            at = canonical[start : min(start + 512, len(scale))]
            squared = (at**2).sum(1)[:, None] - 2 * at @ middles.T + (middles**2).sum(1)
            near = np.exp(-squared / (2 * SCALE_REACH**2))
            scale[start : start + 512] = np.sqrt((near @ own) / (near @ usual))
        return scale

    @cached_property
    def size(self) -> float:
        """How many times as long as the template's this head is."""
        _, own, usual = self._outer_areas
        return float(np.sqrt(own.sum() / usual.sum()))

    @cached_property
    def _outer_areas(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Quads of the outer skin, their areas here and on the template."""
        skin = list(self.template.part_names).index("skin")
        quads = self.faces[np.asarray(self.template.part)[: len(self.faces)] == skin]
        canonical = np.asarray(self.template.vertices)
        return quads, _quad_areas(self.neutral, quads), _quad_areas(canonical, quads)

    def in_region(self, name: str) -> np.ndarray:
        """S truth values."""
        return np.asarray(self.template.region) == list(self.template.region_names).index(name)

    def vertices_between(self, part: str, other: str) -> np.ndarray:
        """Control vertices that faces of both parts share: the margin of the lids, of the lips."""
        names = np.asarray(self.template.part_names)[self.template.part[: len(self.faces)]]
        return np.intersect1d(self.faces[names == part], self.faces[names == other])

    def landmark(self, name: str) -> int:
        """Vertex of a landmark; a paired one by its full name, such as mouth_corner.L."""
        names = list(self.template.landmark_names)
        if name not in names:
            raise _core.InvalidInput(
                f"the template has no landmark {name!r}; it has {', '.join(names)}"
            )
        return int(self.template.landmark_vertices[names.index(name)])


@dataclass(frozen=True)
class Place:
    """A point fixed to a refined vertex: it goes where the vertex goes on another person."""

    vertex: int
    offset: np.ndarray  # from the vertex, along the skin, m on the template
    depth: float  # inwards from the skin, m on the template

    def position(self, mesh: SkinMesh) -> np.ndarray:
        away = self.offset - self.depth * mesh.normals[self.vertex]
        return mesh.vertices[self.vertex] + self.scale(mesh) * away

    def scale(self, mesh: SkinMesh) -> float:
        """How many times as long as on the template lengths are here."""
        return float(self.on_vertex(mesh, mesh.local_scale))

    def on_vertex(self, mesh: SkinMesh, values: np.ndarray) -> np.ndarray:
        """What the refined vertex has of values (S x ...) of the skin's control vertices."""
        indptr, indices, weights = mesh.stencils
        own = slice(indptr[self.vertex], indptr[self.vertex + 1])
        return weights[own] @ values[indices[own]]


def find_place(mesh: SkinMesh, anchor: str, x: float, y: float, depth: float, side: str) -> Place:
    """The place on the skin that lies x, y millimetres from a landmark as seen from the front.

    mesh: the template's own; anchor: a landmark's name without .L/.R; x: away from the midline on
    side "L" or "R"; depth: mm.
    """
    names = list(mesh.template.landmark_names)
    landmark = mesh.landmark(anchor if anchor in names else f"{anchor}.{side}")
    outwards = 1.0 if side == "L" else -1.0
    target = mesh.neutral[landmark, :2] + 1e-3 * np.array([outwards * x, y])
    seen = mesh.seen_from_front
    vertex = int(seen[np.argmin(np.linalg.norm(mesh.vertices[seen, :2] - target, axis=1))])
    normal = mesh.normals[vertex]
    across = target - mesh.vertices[vertex, :2]
    offset = np.array([*across, -(normal[:2] @ across) / normal[2]])
    return Place(vertex, offset, 1e-3 * depth)
