# SPDX-License-Identifier: GPL-3.0-or-later
"""How deep a face is at each place, from frames in which the head is turned otherwise.

The fit to landmarks leaves depth to what faces usually are. Between frames, a point that lies a
millimetre nearer moves further as the head turns. The texture of the reference frame keeps its
rays: where the shape moves, its points slide along them, so that only the part of a change across
the surface counts. Every frame's pose, muscles and articulators are solved along with the shape
and eliminated (bundle adjustment with a prior [Triggs et al. 2000], one linear step), and so is
what shifts the skin's places in all frames alike: only what changes with the turn is depth.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_shape import face_shape
from mimetic.fit.views import spread_points
from mimetic.shared import pinhole
from mimetic.skin.mesh import SkinMesh
from mimetic.solve.sightings import Sighting, at_points, distinct_points, smooth_field, weigh
from mimetic.template.face_template import FaceTemplate

Floats = NDArray[np.float64]
# Metres: what the skin does between frames that no muscle of the model does.
MODEL_ERROR = 0.5e-3
LEAST_COSINE = 0.5  # of a ray on the skin: beyond, a change is taken for no deeper than there
# Pupil distances: the landmarks hold the shape in the picture, and what goes with that in depth.
LANDMARK_HELD, POINT_HELD = 0.01, 0.02
PUPIL_DISTANCE = 0.062  # metres
DEPTH_HELD = 1e-3  # metres, of the whole face: all of it nearer and smaller looks the same
LEAST_SIGHTINGS = 3
# Metres: noise of the reference texture and light on it shift a place alike in every frame.
LASTING_ERROR = 1e-3
ALIKE = np.radians(0.4)  # heads turned by no more than about that show the same errors again


def find_relief(
    fit: FaceFit,
    template: FaceTemplate,
    sightings: Sequence[Sighting],
    modes: Floats,
    std: Floats,
) -> list[float]:
    """Coefficients of the components of `face_shape` by which the fitted head should differ.

    sightings: of the fitted head in several frames; modes: M x S x 3 and std: M, prior, of the
    muscles and articulators with which it was followed. Empty with too few frames to tell.
    """
    if len(sightings) < LEAST_SIGHTINGS:
        return []
    count = template.num_skin_vertices
    mesh = SkinMesh(template, np.ascontiguousarray(fit.neutral_vertices(template)))
    components = face_shape(template).components[:, :count]
    vertices, barycentric, places = distinct_points(sightings)
    rest = at_points(mesh, vertices, barycentric, mesh.neutral[None, :count])[:, :, 0]
    by_mode = at_points(mesh, vertices, barycentric, modes)
    normals = np.einsum("kc,kcx->kx", barycentric, mesh.normals[vertices])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    outwards = np.einsum("kx,kxm->km", normals, at_points(mesh, vertices, barycentric, components))
    deeper = _slid(rest, normals, outwards, fit.head_pose)
    lasting = _lasting(rest, fit.head_pose)
    asked = np.concatenate([deeper, lasting], axis=2)
    information = np.eye(asked.shape[2])
    information[: len(components), : len(components)] += _held(fit, template, mesh.neutral)
    pull = np.zeros(len(information))
    for sighting, at, share in zip(sightings, places, _shares(sightings), strict=True):
        seen = weigh(
            sighting, rest[at], by_mode[at], fit.intrinsics, fit.head_pose, MODEL_ERROR, 0.0
        )
        rows = [seen.by_point @ columns for columns in (std * by_mode[at], asked[at])]
        moved, shape = (row.reshape(len(seen.displacement), -1) for row in rows)
        others = np.hstack([seen.errors, moved])
        gain = np.linalg.solve(np.eye(others.shape[1]) + others.T @ others, others.T)
        left = shape - others @ (gain @ shape)
        information += share * (shape.T @ left)
        pull += share * (left.T @ seen.displacement)
    found = np.linalg.solve(information, pull)
    return np.round(found[: len(components)], 6).tolist()


def _shares(sightings: Sequence[Sighting]) -> Floats:
    """By how much each counts: those in which the head is turned alike err alike."""
    rotations = np.array([one.camera_from_head[:3, :3] for one in sightings])
    cosines = (np.einsum("aij,bij->ab", rotations, rotations) - 1) / 2
    angles = np.arccos(np.clip(cosines, -1, 1))
    return 1 / np.exp(-0.5 * (angles / ALIKE) ** 2).sum(axis=1)


def _lasting(rest: Floats, reference: Floats) -> Floats:
    """K x 3 x E metres of a smooth field of unit variance across the reference frame's view."""
    field = LASTING_ERROR * smooth_field(rest)
    return np.concatenate([reference[axis, :3, None] * field[:, None] for axis in (0, 1)], axis=2)


def _slid(rest: Floats, normals: Floats, outwards: Floats, reference: Floats) -> Floats:
    """K x 3 x C metres by which points move along the reference frame's rays.

    rest, normals: K x 3; outwards: K x C, of the components along the normals
    """
    rays = rest + reference[:3, :3].T @ reference[:3, 3]
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    facing = np.minimum((rays * normals).sum(axis=1), -LEAST_COSINE)
    return rays[:, :, None] * (outwards / facing[:, None])[:, None]


def _held(fit: FaceFit, template: FaceTemplate, neutral: Floats) -> Floats:
    """C x C information: the reference frame shows the head as it was fitted, and as near."""
    components = face_shape(template).components
    pupils = PUPIL_DISTANCE * fit.intrinsics[0, 0] / fit.head_pose[2, 3]  # pixels
    held = np.zeros((len(components), len(components)))
    for vertices, share in (
        (np.asarray(template.landmark_vertices), LANDMARK_HELD),
        (spread_points(template), POINT_HELD),
    ):
        _, by_point, _ = pinhole.show(neutral[vertices], fit.head_pose, fit.intrinsics)
        rows = np.einsum("kpx,mkx->kpm", by_point, components[:, vertices]) / (share * pupils)
        flat = rows.reshape(-1, len(components))
        held += flat.T @ flat
    deeper = components[:, spread_points(template)] @ fit.head_pose[2, :3]
    whole = deeper.mean(axis=1) / DEPTH_HELD
    return held + np.outer(whole, whole)
