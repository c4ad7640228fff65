# SPDX-License-Identifier: GPL-3.0-or-later
"""Other frames of a clip beside the reference: what they show together, one alone does not.

A single picture hardly tells a bent head from other proportions. Between frames in which the head
has turned, near parts of the face move further than far ones: that tells depth, and with it pitch.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitted_view import FittedView
from mimetic.shared import pinhole
from mimetic.shared.luminance import GREY
from mimetic.shared.sampling import sampled
from mimetic.skin.mesh import quad_normals
from mimetic.template.face_template import FaceTemplate

MOST_VIEWS = 6  # beside the reference
LEAST_TURN = 0.04  # pupil distances that the nose moves against the eyes: some two degrees
LEAST_USUAL = 0.3  # of `rest.usual_expression`
NUM_POINTS = 90
POINT_REGIONS = (
    *("forehead", "brow", "nasal_bridge", "nose", "cheek", "zygomatic"),
    *("upper_lip", "lower_lip", "chin", "temple"),
)
LEAST_COSINE = 0.35  # between a point's normal and the way to the camera
# Pupil distances: flow's own error, and what faces do between two frames at rest. Points move alike
# wrongly, so that smaller values let motion outweigh the landmarks of a good single fit
FLOW_SIGMA = 0.036
LARGEST_MISMATCH = 0.04  # pupil distances between flow there and back


@dataclass(frozen=True)
class Candidate:
    """A frame in which a face was found."""

    frame: int
    features: _core.FaceFeatures
    usual: float  # 0 to 1, how usual its expression is in the clip


def choose_views(reference: Candidate, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Frames at rest in which the head is turned otherwise than in the reference and each other."""
    signs = {c.frame: turn_signs(c.features) for c in candidates}
    chosen = [turn_signs(reference.features)]
    rest = [c for c in candidates if c.frame != reference.frame and c.usual >= LEAST_USUAL]
    views: list[Candidate] = []
    while rest and len(views) < MOST_VIEWS:
        apart = [min(np.linalg.norm(signs[c.frame] - s) for s in chosen) for c in rest]
        best = int(np.argmax(apart))
        if apart[best] < LEAST_TURN:
            break
        views.append(rest.pop(best))
        chosen.append(signs[views[-1].frame])
    return views


def follow_points(
    reference: NDArray[np.uint8],
    image: NDArray[np.uint8],
    at_reference: FaceFit,
    view: FittedView,
    template: FaceTemplate,
) -> NDArray[np.float64]:
    """How far points of the face moved from the reference frame to a view's: K x 4.

    Columns: vertex, right, down, standard deviation (pixels). Flow starts where both fits say the
    face is; points that the flow back does not return to are left out.
    """
    neutral = at_reference.neutral_vertices(template)
    spread = spread_points(template)
    before, after = (
        pinhole.show(neutral[spread], pose, at_reference.intrinsics)[0]
        for pose in (at_reference.head_pose, view.head_pose)
    )
    normals = quad_normals(neutral, template.faces)[spread]
    facing = np.minimum(
        _cosines(neutral[spread], normals, at_reference.head_pose),
        _cosines(neutral[spread], normals, view.head_pose),
    )
    height, width = reference.shape[:2]
    inside = ((before > 2) & (before < (width - 3, height - 3))).all(axis=1)
    inside &= ((after > 2) & (after < (width - 3, height - 3))).all(axis=1)
    kept = inside & (facing > LEAST_COSINE)
    if kept.sum() < 12:
        return np.zeros((0, 4))
    spread, before, after = spread[kept], before[kept], after[kept]
    greys = [np.round(one @ GREY).astype(np.uint8) for one in (reference, image)]
    there = _flow(*greys, before, after)
    back = _flow(greys[1], greys[0], after, before)
    shift = sampled(there, before).astype(np.float64)
    mismatch = np.linalg.norm(shift + sampled(back, before + shift), axis=1)
    pupils = [np.array(f.position) for f in view.measured.features if f.name.startswith("pupil.")]
    distance = float(np.linalg.norm(pupils[0] - pupils[1]))
    sure = mismatch < LARGEST_MISMATCH * distance
    sigma = np.hypot(FLOW_SIGMA * distance, mismatch)
    return np.column_stack([spread, shift, sigma])[sure]


def turn_signs(features: _core.FaceFeatures) -> NDArray[np.float64]:
    """Places of nose and mouth against the eyes, pupil distances: they move as the head turns."""
    at = {f.name: np.array(f.position) for f in features.features}
    across = at["pupil.L"] - at["pupil.R"]
    axes = np.array([across, [-across[1], across[0]]]) / (across @ across)
    middle = (at["pupil.L"] + at["pupil.R"]) / 2
    nose = axes @ ((at["ala.L"] + at["ala.R"]) / 2 - middle)
    return nose


@lru_cache(maxsize=2)
def spread_points(template: FaceTemplate) -> NDArray[np.int64]:
    """Skin vertices well apart over the face."""
    points = template.vertices[: template.num_skin_vertices]
    normals = quad_normals(template.vertices, template.faces)[: len(points)]
    allowed = template.in_region(*POINT_REGIONS) & (normals[:, 2] > LEAST_COSINE)
    chosen = [template.landmark("nose_tip")]
    distance = np.where(allowed, np.linalg.norm(points - points[chosen[0]], axis=1), -1)
    while len(chosen) < NUM_POINTS:
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return np.array(chosen)


def _flow(before, after, start, end) -> NDArray[np.float32]:
    """Flow field (H,W,2), searched from the affine motion nearest to the points' own."""
    height, width = before.shape
    known = np.column_stack([start, np.ones(len(start))])
    affine = np.linalg.lstsq(known, end - start, rcond=None)[0]
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    initial = np.stack([x, y, np.ones_like(x)], axis=2) @ affine
    options = _core.FlowOptions()
    options.method = _core.FlowMethod.dis
    initial = np.ascontiguousarray(initial, dtype=np.float32)
    return np.asarray(_core.compute_flow(before, after, options, initial).flow)


def _cosines(points, normals, pose) -> NDArray[np.float64]:
    """Between normals and the way to the camera; points and normals in the head frame."""
    in_camera = points @ pose[:3, :3].T + pose[:3, 3]
    turned = normals @ pose[:3, :3].T
    return -(turned * in_camera).sum(axis=1) / np.linalg.norm(in_camera, axis=1)
