# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lids' margins and lips' edges run on the canonical head, for the line evidence."""

from __future__ import annotations

import numpy as np

from mimetic import _core
from mimetic.fit.fitting import FaceFit
from mimetic.locate.feature_networks import (
    eye_regressor,
    feature_anchors,
    installed_networks,
    occlusion_network,
)
from mimetic.muscles.anatomy import Anatomy
from mimetic.muscles.extras import LIP_CLOSING
from mimetic.muscles.feature_lines import feature_lines
from mimetic.template.face_template import FaceTemplate

SIDES = ("L", "R")
# To its side for 1 straight ahead: lids lie on a round face
EYE_FACES = 0.3
# A lid's margins and lips' edges, from corner to corner
Lines = list[list[int]]


def feature_inputs(fit: FaceFit, template: FaceTemplate, anatomy: Anatomy) -> _core.FeatureInputs:
    """For a tracker of the fitted head: by networks, or the eyes alone where there are none."""
    first, names = len(anatomy.muscle_names), list(anatomy.articulator_names)
    openings = []
    for side, lines in zip(SIDES, lid_lines(template), strict=True):
        facing = np.array([EYE_FACES if side == "L" else -EYE_FACES, 0.0, 1.0])
        upper, lower = (first + names.index(f"lid_{lid}.{side}") for lid in ("upper", "lower"))
        openings.append(_core.FeatureOpening(lines, facing, [upper], upper, lower))
    closing = [first + names.index(name) for name in LIP_CLOSING if name in names]
    ahead, jaw = np.array([0.0, 0.0, 1.0]), first + names.index("jaw_open")
    openings.append(_core.FeatureOpening(lip_lines(template), ahead, closing, jaw=jaw))
    anchors = feature_anchors(fit.neutral_vertices(template), template)
    return _core.FeatureInputs(
        openings,
        installed_networks() or eye_regressor(),
        fit.camera,
        np.ascontiguousarray(anchors),
        occlusion_network(),
        fit.still_cover.in_core(),
    )


def lid_lines(template: FaceTemplate) -> tuple[Lines, Lines]:
    """Upper and lower margin of the left and the right eye, from outer to inner corner."""
    lines = feature_lines(template)
    left, right = ([lines[f"lid_{lid}.{side}"] for lid in ("upper", "lower")] for side in SIDES)
    return left, right


def lip_lines(template: FaceTemplate) -> Lines:
    """Outer upper, inner upper, inner lower, outer lower edge, from the subject's right to left."""
    lines = feature_lines(template)
    return [lines[f"lip_{edge}"] for edge in ("upper", "upper_inner", "lower_inner", "lower")]
