# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the skin was seen in a frame, as displacements that a person's modes should explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.shared import pinhole
from mimetic.skin.mesh import SkinMesh, multiply

Floats = NDArray[np.float64]
MOST_POINTS = 350  # of a frame that are worked with, spread evenly
POSE_STD = np.array([0.1, 0.1, 0.1, 0.02, 0.02, 0.02])  # rad, metres: nearly free
# What no skin of ours explains: a smooth field with these s.d. of its amplitude
MODEL_ERROR = 0.3e-3  # metres, whatever moves
SHAPE_ERROR = 4e-3  # metres of depth, seen as the head turns; the capture's own is an eighth
MOTION_ERROR = 0.1  # of the displacement, beside what calibration may change
CORRELATION_LENGTH = 0.012  # metres over the skin
NODE_SPACING = 0.02


@dataclass(frozen=True)
class Sighting:
    """K points of the skin in one frame, and the state that the capture gave it."""

    frame: int
    camera_from_head: Floats  # 4 x 4, metres
    values: Floats  # M
    vertices: NDArray[np.int32]  # K x 3, refined vertices around each point
    barycentric: Floats  # K x 3
    pixels: Floats  # K x 2, by flow alone
    information: Floats  # K x 2 x 2

    @classmethod
    def of(
        cls, frame: int, estimate: _core.FrameEstimate, seen: _core.SkinObservations
    ) -> Sighting:
        """Of a frame that the tracker has just advanced to."""
        information = np.asarray(seen.information).reshape(-1, 2, 2)
        kept = np.flatnonzero(np.trace(information, axis1=1, axis2=2) > 0)
        share = max(1, -(-len(kept) // MOST_POINTS))
        kept = kept[::share]
        return cls(
            frame,
            np.array(estimate.camera_from_head),
            np.array(estimate.values),
            np.asarray(seen.vertices)[kept],
            np.asarray(seen.barycentric)[kept],
            np.asarray(seen.pixels)[kept],
            share * information[kept],
        )


def at_points(
    mesh: SkinMesh, vertices: NDArray[np.int32], barycentric: Floats, modes: Floats
) -> Floats:
    """K x 3 x M of points as a sighting has them (K x 3 each), from modes M x S x 3 of the skin."""
    used, place = np.unique(vertices, return_inverse=True)
    indptr, indices, weights = mesh.stencils
    rows = [np.arange(indptr[v], indptr[v + 1]) for v in used]
    starts = np.concatenate([[0], np.cumsum([len(row) for row in rows])]).astype(np.int32)
    entries = np.concatenate(rows)
    stencils = (starts, indices[entries], weights[entries])
    refined = multiply(stencils, modes.transpose(1, 2, 0))
    corners = refined[place.reshape(vertices.shape)]
    return np.einsum("kc,kcxm->kxm", barycentric, corners)


def distinct_points(
    sightings: Sequence[Sighting],
) -> tuple[NDArray[np.int32], Floats, list[NDArray[np.int64]]]:
    """Vertices (P x 3) and barycentric coordinates (P x 3) of all seen points, each of them once.

    Third: for each sighting, which of these its own points are (K).
    """
    rows = np.concatenate([np.hstack([one.vertices, one.barycentric]) for one in sightings])
    points, place = np.unique(rows, axis=0, return_inverse=True)
    ends = np.cumsum([len(one.pixels) for one in sightings])[:-1]
    return points[:, :3].astype(np.int32), points[:, 3:], np.split(place.reshape(-1), ends)


@dataclass(frozen=True)
class Weighed:
    """A frame's measured displacements in standard deviations of their own noise."""

    displacement: Floats  # 2K, from the neutral
    by_point: Floats  # K x 2 x 3, of these a metre in the head frame
    errors: Floats  # 2K x E, of a standard deviation of the pose and of smooth model error


def weigh(
    sighting: Sighting,
    rest: Floats,
    modes: Floats,
    intrinsics: Floats,
    reference: Floats,
    model_error: float = MODEL_ERROR,
    shape_error: float = SHAPE_ERROR,
) -> Weighed:
    """Displacements from the neutral, and what is common to them but no motion of the skin.

    rest: the seen points in the head frame, K x 3; modes: those that the capture used, there,
    K x 3 x M; intrinsics: 3 x 3, pixels; reference: 4 x 4, pose of the fitted frame; model_error:
    metres, whatever moves; shape_error: metres of depth, seen as the head turns.
    """
    count = len(sighting.pixels)
    moved = modes @ sighting.values
    seen_from = sighting.camera_from_head
    pixels, by_point, by_pose = pinhole.show(rest + moved, seen_from, intrinsics)
    found = sighting.pixels - pixels + np.einsum("kpx,kx->kp", by_point, moved)
    view = _view(reference) @ _view(seen_from)
    error = np.hypot(
        np.hypot(model_error, shape_error * np.sqrt(max(0.0, 1 - view**2))),
        MOTION_ERROR * np.linalg.norm(moved, axis=1),
    )
    field = smooth_field(rest) * error[:, None]
    across = np.einsum("kpx,kn->kpnx", by_point[:, :, :2], field).reshape(count, 2, -1)
    errors = np.concatenate([by_pose * POSE_STD, across], axis=2)
    roots = np.linalg.cholesky(sighting.information + 1e-12 * np.eye(2)).transpose(0, 2, 1)
    return Weighed(
        np.einsum("kij,kj->ki", roots, found).reshape(-1),
        roots @ by_point,
        (roots @ errors).reshape(2 * count, -1),
    )


@dataclass(frozen=True)
class Whitened:
    """A frame's measured displacements, and what turns displacements of its points into them."""

    sighting: Sighting
    displacement: Floats  # 2K, whitened
    by_point: Floats  # 2K x 3K, whitened pixels a metre in the head frame


def whiten(sighting: Sighting, weighed: Weighed) -> Whitened:
    """Free of pose and smooth model error, the noise of unit variance."""
    count = len(weighed.by_point)
    root = np.linalg.cholesky(np.eye(2 * count) + weighed.errors @ weighed.errors.T)
    spread = np.zeros((count, 2, count, 3))
    at = np.arange(count)
    spread[at, :, at] = weighed.by_point
    both = np.column_stack([weighed.displacement, spread.reshape(2 * count, 3 * count)])
    both = np.linalg.solve(root, both)
    return Whitened(sighting, both[:, 0], both[:, 1:])


def _view(pose: Floats) -> Floats:
    """Direction from the head to the camera, head frame."""
    towards = -pose[:3, :3].T @ pose[:3, 3]
    return towards / np.linalg.norm(towards)


def smooth_field(points: Floats) -> Floats:
    """K x nodes: heights of unit variance of a field over the skin."""
    nodes = points[:0]
    for point in points:
        if len(nodes) == 0 or np.linalg.norm(nodes - point, axis=1).min() > NODE_SPACING:
            nodes = np.vstack([nodes, point])
    square = ((points[:, None] - nodes) ** 2).sum(axis=2)
    heights = np.exp(-square / (2 * CORRELATION_LENGTH**2))
    return heights / np.linalg.norm(heights, axis=1, keepdims=True)
