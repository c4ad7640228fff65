# SPDX-License-Identifier: GPL-3.0-or-later
"""Other frames of a clip beside the reference: what they show together, one alone does not.

A single picture hardly distinguishes a bent head from other proportions. Between frames in which
the head has turned, near parts of the face move further than far ones: that gives depth and pitch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.fitted_view import FittedView
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
LEAST_COSINE = 0.35  # between a point's normal and straight ahead


@dataclass(frozen=True)
class Candidate:
    """A frame in which a face was found."""

    frame: int
    features: _core.FaceFeatures
    usual: float  # 0 to 1, how usual its expression is in the clip


def choose_views(reference: Candidate, candidates: Sequence[Candidate]) -> list[Candidate]:
    """Frames at rest in which the head is turned otherwise than in the reference and each other."""
    rest = [c for c in candidates if c.frame != reference.frame and c.usual >= LEAST_USUAL]
    turns = np.array([turn_signs(c.features) for c in (reference, *rest)])
    is_allowed = [True] * len(turns)
    indices = _core.spread_rows(turns, [0], is_allowed, 1 + MOST_VIEWS, LEAST_TURN)[1:]
    return [rest[i - 1] for i in indices]


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
    vertices = spread_points(template)
    pupils = [np.array(f.position) for f in view.measured.features if f.name.startswith("pupil.")]
    return _core.follow_points(
        np.ascontiguousarray(reference),
        np.ascontiguousarray(image),
        at_reference.camera,
        at_reference.head_pose,
        view.head_pose,
        vertices,
        neutral[vertices],
        quad_normals(neutral, template.faces)[vertices],
        math.dist(*pupils),
    )


def turn_signs(features: _core.FaceFeatures) -> NDArray[np.float64]:
    """Places of nose and mouth against the eyes, pupil distances: they move as the head turns."""
    at = {f.name: np.array(f.position) for f in features.features}
    across = at["pupil.L"] - at["pupil.R"]
    axes = np.array([across, [-across[1], across[0]]]) / (across @ across)
    middle = (at["pupil.L"] + at["pupil.R"]) / 2
    nose = axes @ ((at["ala.L"] + at["ala.R"]) / 2 - middle)
    return nose


@lru_cache(maxsize=2)
def spread_points(template: FaceTemplate) -> list[int]:
    """Skin vertices well apart over the face."""
    points = template.vertices[: template.num_skin_vertices]
    normals = quad_normals(template.vertices, template.faces)[: len(points)]
    is_allowed = template.in_region(*POINT_REGIONS) & (normals[:, 2] > LEAST_COSINE)
    return _core.spread_rows(
        points, [template.landmark("nose_tip")], is_allowed.tolist(), NUM_POINTS
    )
