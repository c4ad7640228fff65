# SPDX-License-Identifier: GPL-3.0-or-later
"""Which place on a performance's surface a pixel shows.

Where the fitted surface turns away or hides behind something nearer, a pixel's ray meets it
anywhere: far down the throat between two lips, on the neck beside the chin, far back on a temple.
What the pixel shows there is, within the fit's error, the nearest skin that faces the camera; at
the outline, what rays about it meet in the middle of their depths.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

LEVELS = 2  # of refinement: facets of a millimetre or two
RAYS_AT_ONCE = 64
TILE_PX = 16.0
COVERED = 2e-3  # metres behind the surface that still count as seen
STEEP = 0.2  # cosine between normal and view below which a ray's place is not to be trusted
REACH = 5e-3  # metres beside the ray, as seen, within which facing skin is looked for
STEEPEST = np.sqrt(1 / STEEP**2 - 1)  # depth over breadth of skin that is just not steep
BEHIND = 3e-3  # metres deeper than facing skin beside it allows: hidden, were the outline right
LEAST_FACING = 0.1  # cosine with which skin can be told from what turns away
OUTLINE = 0.15  # cosine below which the outline's error decides where a ray meets the skin
OUTLINE_ERROR = 1.5e-3  # metres, of a fit, in the picture
OUTLINE_RINGS, OUTLINE_SPOKES = (0.6, 1.2, 1.9), 8  # radii in errors, rays on each


@dataclass(frozen=True)
class Places:
    """What K pixels show."""

    on_face: NDArray[np.bool_]  # K; pixels off it are given the nearest skin all the same
    triangle: NDArray[np.int64]  # K
    weights: NDArray[np.float64]  # K x 3, of the triangle's corners
    offset: NDArray[np.float64]  # K x 2, pixels from the place to the pixel; 0 but at outlines


class RefinedSurface:
    """The performance's limit surface, refined to small facets."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        self.used, faces = np.unique(_opaque(performance.faces), return_inverse=True)
        faces = np.ascontiguousarray(faces.reshape(-1, 4), dtype=np.int32)
        self.mesh = _core.SubdividedMesh(faces, len(self.used), LEVELS)
        self.faces = np.ascontiguousarray(self.mesh.faces, dtype=np.int32)
        self.triangles = np.concatenate([self.faces[:, [0, 1, 2]], self.faces[:, [0, 2, 3]]])
        k = performance.intrinsics
        width, height = (int(side) for side in performance.image_size)
        self.camera = _core.Camera(k[0, 0], k[1, 1], k[0, 2], k[1, 2], width, height)

    def in_camera(self, i: int) -> NDArray[np.float64]:
        control = np.ascontiguousarray(self.performance.surface_in_camera(i)[self.used])
        return np.ascontiguousarray(self.mesh.positions(control))


def _opaque(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """All faces but the lashes: cards a centimetre before the skin that shows between the hairs."""
    template = load_template()
    if not np.array_equal(faces, template.faces):
        return faces
    return np.delete(faces, template.part_faces("lashes.L", "lashes.R"), axis=0)


def places_under(
    surface: RefinedSurface, pixels: NDArray[np.float64], frame_index: int = 0
) -> Places | None:
    """The place that each pixel (K x 2) shows in one frame; None if no skin faces the camera."""
    vertices = surface.in_camera(frame_index)
    facing, owner = _facing_skin(surface, vertices)
    if len(facing) == 0:
        return None
    triangle, weights = _under_rays(surface, pixels, vertices)
    on_face = triangle >= 0
    shown = surface.performance.project(vertices[facing])
    moved = np.where(on_face, -1, 0)
    for k in np.flatnonzero(~on_face):
        moved[k] = np.linalg.norm(shown - pixels[k], axis=1).argmin()
    corners = vertices[surface.triangles[triangle[on_face]]]
    hit = np.einsum("kc,kcx->kx", weights[on_face], corners)
    steep = cosines(corners, hit) < STEEP
    by_x = np.argsort(shown[:, 0])
    for k, place, turned_away in zip(np.flatnonzero(on_face), hit, steep, strict=True):
        reach = REACH * surface.performance.intrinsics[0, 0] / place[2]
        ends = pixels[k, 0] - reach, pixels[k, 0] + reach
        beside = np.sort(by_x[slice(*np.searchsorted(shown[:, 0], ends, sorter=by_x))])
        depths = vertices[facing[beside], 2]
        before = _skin_before(surface, pixels[k], place, turned_away, shown[beside], depths)
        if before >= 0:
            moved[k] = beside[before]
    kept = moved < 0
    at_corner = surface.triangles[owner[moved]] == facing[moved, None]
    places = Places(
        on_face,
        np.where(kept, triangle, owner[moved]),
        np.where(kept[:, None], weights, at_corner),
        np.where(kept[:, None], 0, pixels - shown[moved]),
    )
    return _at_outline(surface, pixels, vertices, places, float(np.median(vertices[facing, 2])))


def meets_face(
    surface: RefinedSurface, pixels: NDArray[np.float64], frame_index: int = 0
) -> NDArray[np.bool_]:
    """Which pixels (K x 2) of one frame show the face at all: `Places.on_face` of `places_under`.

    For many pixels, most of them beside the face, this is to be asked first.
    """
    return _under_rays(surface, pixels, surface.in_camera(frame_index))[0] >= 0


def _at_outline(
    surface: RefinedSurface,
    pixels: NDArray[np.float64],
    vertices: NDArray[np.float64],
    places: Places,
    depth: float,
) -> Places:
    """The same but at the outline, where a ray a pixel beside it may meet skin 2 cm deeper.

    There the place is that of the middle depth among rays spread as far as the outline errs.
    depth: of the face, metres.
    """
    corners = vertices[surface.triangles[places.triangle]]
    at = np.einsum("kc,kcx->kx", places.weights, corners)
    moved = (places.offset != 0).any(axis=1)
    asked = np.flatnonzero(~places.on_face | (~moved & (cosines(corners, at) < OUTLINE)))
    if len(asked) == 0:
        return places
    error = OUTLINE_ERROR * surface.performance.intrinsics[0, 0] / depth  # pixels
    rays, shares = _rays_about(error)
    triangle, weights = _under_rays(surface, (pixels[asked, None] + rays).reshape(-1, 2), vertices)
    corners = vertices[surface.triangles[triangle]]
    met = np.einsum("kc,kcx->kx", weights, corners)
    usable = (triangle >= 0) & (cosines(corners, met) > LEAST_FACING)
    for i, k in enumerate(asked):
        first = i * len(rays)
        hits = first + np.flatnonzero(usable[first : first + len(rays)])
        if len(hits) == 0:
            continue
        hits = hits[np.argsort(met[hits, 2])]
        below = np.cumsum(shares[hits - first])
        middle = hits[np.searchsorted(below, below[-1] / 2)]
        places.triangle[k], places.weights[k] = triangle[middle], weights[middle]
        places.offset[k] = pixels[k] - surface.performance.project(met[middle, None])[0]
    return places


def _rays_about(error: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pixels (R x 2) about a ray and the share of each under a Gaussian of that s.d."""
    turns = 2 * np.pi * np.arange(OUTLINE_SPOKES) / OUTLINE_SPOKES
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    rays = [np.zeros((1, 2))] + [radius * error * circle for radius in OUTLINE_RINGS]
    shares = [np.ones(1)] + [
        np.full(OUTLINE_SPOKES, max(1, radius) * np.exp(-0.5 * radius**2))
        for radius in OUTLINE_RINGS
    ]
    return np.concatenate(rays), np.concatenate(shares)


def _skin_before(
    surface: RefinedSurface,
    pixel: NDArray[np.float64],
    place: NDArray[np.float64],
    turned_away: bool,
    shown: NDArray[np.float64],
    depths: NDArray[np.float64],
) -> int:
    """The facing vertex, among those `shown`, that a pixel shows rather than `place`; -1: none."""
    beside = np.linalg.norm(shown - pixel, axis=1) * place[2] / surface.performance.intrinsics[0, 0]
    near = np.flatnonzero(beside < REACH)
    deepest = depths[near]
    if not turned_away:
        deepest = deepest + BEHIND + STEEPEST * beside[near]
    near = near[place[2] > deepest]
    return int(near[beside[near].argmin()]) if len(near) else -1


def _facing_skin(
    surface: RefinedSurface, vertices: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Vertices that are in sight and not steep, and a triangle that has each."""
    flat = cosines(vertices[surface.triangles], vertices[surface.triangles[:, 0]]) >= STEEP
    owner = np.full(len(vertices), -1)
    steep_too = np.zeros(len(vertices), dtype=bool)
    for corner in range(3):
        owner[surface.triangles[flat, corner]] = np.flatnonzero(flat)
        steep_too[surface.triangles[~flat, corner]] = True
    facing = np.flatnonzero((owner >= 0) & ~steep_too & (vertices[:, 2] > 1e-3))
    if len(facing) == 0:
        return facing, owner[facing]
    points = np.ascontiguousarray(vertices[facing])
    seen = _core.show_points(surface.camera, vertices, surface.faces, points, COVERED)
    return facing[seen], owner[facing[seen]]


def cosines(corners: NDArray[np.float64], at: NDArray[np.float64]) -> NDArray[np.float64]:
    """Between the normals of triangles (K x 3 x 3) and the way to the camera from `at` (K x 3).

    Metres, camera frame.
    """
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1) * np.linalg.norm(at, axis=1)
    return -np.einsum("kx,kx->k", normals, at) / (lengths + 1e-30)


def _under_rays(
    surface: RefinedSurface, pixels: NDArray[np.float64], vertices: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """`find_places`, asked tile by tile: ten times faster for many."""
    performance = surface.performance
    shown = performance.project(vertices)[surface.triangles]
    low, high = shown.min(1), shown.max(1)
    found = np.full(len(pixels), -1)
    weights = np.zeros((len(pixels), 3))
    tiles = np.floor(pixels / TILE_PX)
    for row in np.unique(tiles[:, 1]):
        in_row = np.flatnonzero(tiles[:, 1] == row)
        across = np.flatnonzero(_overlaps(low[:, 1], high[:, 1], row))
        for column in np.unique(tiles[in_row, 0]):
            chosen = across[_overlaps(low[across, 0], high[across, 0], column)]
            if len(chosen) == 0:
                continue
            here = in_row[tiles[in_row, 0] == column]
            triangles = surface.triangles[chosen]
            at, weights[here] = find_places(performance, pixels[here], vertices, triangles)
            found[here] = np.where(at >= 0, chosen[at], -1)
    return found, weights


def _overlaps(
    low: NDArray[np.float64], high: NDArray[np.float64], tile: float
) -> NDArray[np.bool_]:
    """Which spans, pixels, reach into a row or column of tiles."""
    return (high >= TILE_PX * tile) & (low <= TILE_PX * (tile + 1))


def find_places(
    performance: Performance,
    points: NDArray[np.float64],
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int32],
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """The nearest triangle under each pixel (-1: none) and the place in it, K x 3 weights."""
    facing = np.einsum(
        "tx,tx->t",
        np.cross(
            vertices[triangles[:, 1]] - vertices[triangles[:, 0]],
            vertices[triangles[:, 2]] - vertices[triangles[:, 0]],
        ),
        vertices[triangles[:, 0]],
    )
    candidates = np.flatnonzero((facing < 0) & (vertices[triangles, 2] > 1e-3).all(axis=1))
    found = np.full(len(points), -1)
    weights = np.zeros((len(points), 3))
    if len(candidates) == 0:
        return found, weights
    a, b, c = (vertices[triangles[candidates, k]] for k in range(3))
    k = performance.intrinsics
    rays = np.column_stack([points, np.ones(len(points))]) @ np.linalg.inv(k).T
    # The ray s r meets a plane where its corners' weights solve s r = u a + v b + w c; each is a
    # triple product with the ray, and before scaling they sum to 1 / s.
    volume = np.einsum("tx,tx->t", a, np.cross(b, c))
    with np.errstate(divide="ignore", invalid="ignore"):
        planes = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)]) / volume[:, None]
    for first in range(0, len(points), RAYS_AT_ONCE):
        part = slice(first, first + RAYS_AT_ONCE)
        parts = np.einsum("ctx,kx->kct", planes, rays[part])
        total = parts.sum(axis=1)
        inside = (
            np.isfinite(total) & (parts >= -1e-9 * np.abs(total[:, None])).all(axis=1) & (total > 0)
        )
        nearness = np.where(inside, total, -1)  # 1 / s
        best = nearness.argmax(axis=1)
        rows = np.arange(len(best))
        hit = nearness[rows, best] > 0
        found[part] = np.where(hit, candidates[best], -1)
        chosen = parts[rows, :, best]
        weights[part] = np.where(hit[:, None], chosen / chosen.sum(axis=1, keepdims=True), 0)
    return found, weights
