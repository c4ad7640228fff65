# SPDX-License-Identifier: GPL-3.0-or-later
"""The template laid onto another head: by landmarks, then as an elastic skin drawn to the surface.

First a radial-basis warp through the landmarks, then rounds of non-rigid closest points (Amberg
2007) with our own shell as the regulariser: the foundation of `_core.SkinModel` is the pull to the
surface, strong across the skin and weak along it, its membrane and bending keep the mesh even.
Metres, head frame, the template's size.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.skin.closest_points import closest_weights, nearest, triangles_around
from mimetic.skin.mesh import SkinMesh

NORMAL_LENGTH = 0.008  # m that opposite normals count as, halved: lips and lids touch back to back
LIP_LENGTH = 0.008  # m that upper and lower lip count as apart, though they touch
LIP_FULL = 0.010  # m of difference between the ways to the two lips
FAR = 0.15  # m; ways along the skin are followed so far
REACHES = (0.030, 0.015, 0.010)  # m; of the pull in each round
ACROSS, ALONG, LOOSE = 3e6, 1e5, 30.0  # N/m^3; with MEMBRANE the pull evens out over 5 mm
LANDMARK = 1e8
MEMBRANE = {"young": 4e4, "poisson": 0.0, "thickness": 1.5e-3, "pre_stress": 0.0}


@dataclass(frozen=True)
class SkinPlaces:
    """P points on the triangles of a surface."""

    corners: NDArray[np.int64]  # P x 3 vertices
    weights: NDArray[np.float64]  # P x 3, sum to 1
    gaps: NDArray[np.float64]  # P, m from what was looked for

    def values(self, at_vertices: NDArray) -> NDArray[np.float64]:
        """Values at the vertices (N or N x K), interpolated."""
        return np.einsum("pk,pk...->p...", self.weights, at_vertices[self.corners])


class LippedSurface:
    """A skin on which nearest points know inside from outside and upper from lower lip.

    vertices N x 3; lips: points of the upper and the lower lip's vermilion border, 2 x 3.
    """

    def __init__(self, vertices, triangles, surface: _core.MuscleSurface, lips):
        self.vertices, self.triangles = vertices, triangles
        self.normals = surface.normals
        ways = [np.minimum(surface.distances(lip[None], FAR), FAR) for lip in lips]
        self.lip = np.clip((ways[1] - ways[0]) / LIP_FULL, -1, 1)  # 1 on the upper lip
        self._around = triangles_around(triangles, len(vertices))
        self._used = np.unique(triangles)
        self._features = features(vertices, self.normals, self.lip)[self._used]

    def find(self, points, normals, lip) -> SkinPlaces:
        """Nearest places to P points with their outward normals and lips (1 upper, -1 lower)."""
        found = [
            self._find(slice(start, start + 4096), points, normals, lip)
            for start in range(0, len(points), 4096)  # a block at a time: memory stays small
        ]
        return SkinPlaces(*(np.concatenate(values) for values in zip(*found, strict=True)))

    def _find(self, block: slice, points, normals, lip):
        points = points[block]
        vertex = self._used[nearest(features(points, normals[block], lip[block]), self._features)]
        candidates = self.triangles[self._around[vertex]]  # P x K x 3
        weights = closest_weights(points[:, None], self.vertices[candidates])
        places = np.einsum("pkc,pkcx->pkx", weights, self.vertices[candidates])
        gaps = np.linalg.norm(places - points[:, None], axis=2)
        best, rows = np.argmin(gaps, axis=1), np.arange(len(points))
        return candidates[rows, best], weights[rows, best], gaps[rows, best]


def features(points, normals, lip) -> NDArray[np.float64]:
    """P x 7: what has to agree besides the place, as lengths."""
    return np.column_stack([points, NORMAL_LENGTH * normals, LIP_LENGTH * lip])


def lipped(mesh: SkinMesh) -> LippedSurface:
    """A template-shaped head's refined skin."""
    lips = [mesh.neutral[mesh.landmark(name)] for name in ("lip_upper", "lip_lower")]
    return LippedSurface(mesh.vertices, mesh.triangles, mesh.whole_surface, lips)


def warp(points, source, target) -> NDArray[np.float64]:
    """Points P x 3 moved as sources (K x 3) go to targets; displacements by the kernel -r.

    Conditionally positive definite of order 1 (Wendland 2004): a constant is enough beside it, so
    what lies far from all landmarks is neither sheared nor scaled.
    """
    count = len(source)
    system = np.ones((count + 1, count + 1))
    system[:count, :count] = -np.linalg.norm(source[:, None] - source[None], axis=2)
    system[count, count] = 0
    weights = np.linalg.solve(system, np.vstack([target - source, np.zeros(3)]))
    away = -np.linalg.norm(points[:, None] - source[None], axis=2)
    return points + away @ weights[:count] + weights[count]


def lay_template(
    template,
    landmarks: Mapping[str, NDArray[np.float64]],
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int32],
    surface: _core.MuscleSurface,
) -> SkinMesh:
    """The template on another head's skin (N x 3, T x 3).

    Raises InvalidInput if the landmarks cannot belong to this skin.
    """
    held = np.array([template.landmark(name) for name in landmarks])
    targets = np.array(list(landmarks.values()))
    neutral = warp(np.asarray(template.vertices), template.vertices[held], targets)
    with warnings.catch_warnings():  # the template's own folds are no business of the caller
        warnings.simplefilter("ignore")
        mesh = _sound(template, neutral)
        if mesh is None:
            raise InvalidInput(
                "the landmarks do not fit a face (the template folds over on them): "
                f"check {', '.join(landmarks)}"
            )
        for reach in REACHES:
            drawn = _draw(mesh, held, targets, (vertices, triangles, surface), reach)
            closer = _sound(template, drawn)
            if closer is None:  # folded: the round before is less close, and whole
                break
            mesh = closer
    return mesh


def _sound(template, neutral: NDArray[np.float64]) -> SkinMesh | None:
    mesh = SkinMesh(template, neutral)
    try:
        _ = mesh.vertices  # unfolded, or refused
    except InvalidInput:
        return None
    return mesh


def _draw(mesh: SkinMesh, held, targets, head, reach: float) -> NDArray[np.float64]:
    """One round: neutral V x 3 after the skin was drawn to what lies within reach."""
    vertices, triangles, surface = head
    own = lipped(mesh)
    lips = [mesh.neutral[mesh.landmark(name)] for name in ("lip_upper", "lip_lower")]
    other = LippedSurface(vertices, triangles, surface, lips)
    found = other.find(own.vertices, own.normals, own.lip)
    pull = found.values(vertices) - own.vertices
    alike = (found.values(other.normals) * own.normals).sum(axis=1) > 0.3
    outer = np.zeros(len(own.vertices), bool)
    outer[np.unique(mesh.triangles[mesh.triangle_part == "skin"])] = True
    drawn = outer & alike & (found.gaps < reach)
    # The mesh ends there: what lies beyond must not be gathered on its rim.
    drawn &= ~on_rim(triangles, len(vertices))[found.corners].any(axis=1)
    normal = np.where(drawn, ACROSS, LOOSE)
    tangential = np.where(drawn, ALONG, LOOSE)
    pull[~drawn] = 0
    pull[held] = targets - own.vertices[held]  # refined vertex i is the limit of control vertex i
    normal[held] = tangential[held] = LANDMARK
    even = {name: np.full(len(own.vertices), value) for name, value in MEMBRANE.items()}
    materials = _core.SkinMaterials(**even, tangential=tangential, normal=normal)
    count = int(mesh.template.num_skin_vertices)
    model = _core.SkinModel(mesh.vertices, mesh.triangles, materials, mesh.stencils, count)
    moved = model.solve(model.foundation_forces(pull).reshape(-1, 1)).reshape(count, 3)
    neutral = mesh.neutral.copy()
    neutral[:count] += moved
    for name in ("L", "R"):  # eyes and lashes go with their lids
        _carry(mesh, neutral, moved, _margin(mesh, name), (f"eye.{name}", f"lashes.{name}"))
    mouth = mesh.vertices_between("skin", "mouth_cavity")
    _carry(mesh, neutral, moved, mouth, ("teeth_upper", "teeth_lower", "tongue"))
    return neutral


def _margin(mesh: SkinMesh, side: str) -> NDArray[np.int64]:
    edge = mesh.vertices_between("skin", "eye_socket")
    return edge[(mesh.neutral[edge, 0] > 0) == (side == "L")]


def _carry(mesh: SkinMesh, neutral, moved, edge, parts) -> None:
    names = list(mesh.template.part_names)
    faces = mesh.template.faces[np.isin(mesh.template.part, [names.index(p) for p in parts])]
    neutral[np.unique(faces)] += moved[edge].mean(axis=0)


def on_rim(triangles: NDArray[np.int32], num_vertices: int) -> NDArray[np.bool_]:
    """N: which vertices lie on an edge of one triangle only."""
    edges = np.sort(np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    key = edges[:, 0].astype(np.int64) * num_vertices + edges[:, 1]
    _, index, counts = np.unique(key, return_index=True, return_counts=True)
    rim = np.zeros(num_vertices, bool)
    rim[edges[index[counts == 1]]] = True
    return rim
