# SPDX-License-Identifier: GPL-3.0-or-later
"""Where lids' margins and lips' edges run on the canonical head, for the evidence there."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mimetic import _core
from mimetic.fit.fitting import FaceFit
from mimetic.locate.feature_networks import feature_anchors, installed_networks
from mimetic.muscles.anatomy import Anatomy
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.skin.mesh import canonical_skin
from mimetic.template.face_template import FaceTemplate

SIDES = ("L", "R")
# To its side for 1 straight ahead: lids lie on a round face
EYE_FACES = 0.3
# A lid's margins and lips' edges, from corner to corner
Lines = list[list[int]]


def feature_inputs(fit: FaceFit, template: FaceTemplate, anatomy: Anatomy) -> _core.FeatureInputs:
    """For a tracker of the fitted head: by the networks where they are installed."""
    first, names = len(anatomy.muscle_names), list(anatomy.articulator_names)
    openings = []
    for side, lines in zip(SIDES, lid_lines(template), strict=True):
        facing = np.array([EYE_FACES if side == "L" else -EYE_FACES, 0.0, 1.0])
        upper, lower = (first + names.index(f"lid_{lid}.{side}") for lid in ("upper", "lower"))
        openings.append(_core.FeatureOpening(lines, facing, upper, lower))
    openings.append(_core.FeatureOpening(lip_lines(template), np.array([0.0, 0.0, 1.0])))
    anchors = feature_anchors(fit.neutral_vertices(template), template)
    return _core.FeatureInputs(
        eye_slits(template, anatomy),
        openings,
        installed_networks(),
        fit.camera,
        np.ascontiguousarray(anchors),
    )


def eye_slits(template: FaceTemplate, anatomy: Anatomy) -> list[_core.EyeSlit]:
    """The two eyes' openings, left first."""
    names = list(anatomy.articulator_names)
    first = len(anatomy.muscle_names)
    return [
        _core.EyeSlit(
            inner=template.landmark(f"eye_inner.{side}"),
            outer=template.landmark(f"eye_outer.{side}"),
            upper=template.landmark(f"lid_upper.{side}"),
            lower=template.landmark(f"lid_lower.{side}"),
            lid_upper=first + names.index(f"lid_upper.{side}"),
            lid_lower=first + names.index(f"lid_lower.{side}"),
        )
        for side in SIDES
    ]


@lru_cache(maxsize=2)
def lid_lines(template: FaceTemplate) -> tuple[Lines, Lines]:
    """Upper and lower margin of the left and the right eye, from outer to inner corner."""
    eyes = []
    for frame in eye_frames(canonical_skin(template)):
        lids = EyeLids(frame)
        eyes.append(
            [
                sorted(map(int, margin), key=lambda v: -abs(template.vertices[v, 0]))
                for margin in (lids.upper, lids.lower)
            ]
        )
    return eyes[0], eyes[1]


@lru_cache(maxsize=2)
def lip_lines(template: FaceTemplate) -> Lines:
    """Outer upper, inner upper, inner lower, outer lower edge, from the subject's right to left.

    The mesh's loops about the mouth run along the edges of the red, and along the line in which
    closed lips meet.
    """
    outer_upper, outer_lower = _lips_of_loop(template, "lip_upper", "lip_lower")
    inner_upper, inner_lower = _lips_of_loop(template, "lip_upper_inner", "lip_lower_inner")
    return [outer_upper, inner_upper, inner_lower, outer_lower]


def _lips_of_loop(template: FaceTemplate, upper: str, lower: str) -> tuple[list[int], list[int]]:
    """A loop about the mouth, through two landmarks on the midline, parted at its ends."""
    x = template.vertices[:, 0]
    lips = []
    for name, other in ((upper, lower), (lower, upper)):
        middle = template.landmark(name)
        quads, corners = np.nonzero(template.skin_faces == middle)
        neighbours = template.skin_faces[np.r_[quads, quads], np.r_[corners - 1, (corners + 1) % 4]]
        towards_left = int(neighbours[np.argmax(x[neighbours])])
        loop = _core.edge_loop(template.skin_faces, middle, towards_left)
        half = loop[: loop.index(template.landmark(other))]
        half = half[: int(np.argmax(x[half])) + 1]
        lips.append([int(template.mirror[v]) for v in reversed(half[1:])] + half)
    return lips[0], lips[1]
