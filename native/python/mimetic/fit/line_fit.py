# SPDX-License-Identifier: GPL-3.0-or-later
"""Lids and lips of a fitted head, moved to where the networks see them in frames at rest.

A capture starts from the fitted head: what its proportions leave between the head's lines and those
that are seen would stay in every frame. What networks and a person have in common stays here, too;
so several frames together count as one, whose errors of their own are averaged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import moved_model
from mimetic.fit.fitted_view import FittedView
from mimetic.fit.line_modes import line_modes
from mimetic.template.face_template import FaceTemplate

# Lines that nothing else sees
SEEN_BY_NETWORKS = {f"lid_{lid}.{side}" for lid in ("upper", "lower") for side in "LR"}
OPEN = 0.8  # of how far the eye is open in most of the frames: with less it blinks or looks down


def with_lines(fit: FaceFit, others: Sequence[FittedView], template: FaceTemplate) -> FaceFit:
    """The fit with lids and lips as seen in its reference frame, and in others at rest.

    Others in which an eye is less open than in most are left out. The fit as it is where the
    networks saw nothing in the reference frame.
    """
    if not fit.views or not _is_seen(fit.views[0]):
        return fit
    views = _with_open_eyes([fit.views[0], *filter(_is_seen, others)])
    modes = line_modes(template)
    model = moved_model(template, replace(fit, lines=[]).neutral_vertices(template), modes)
    focal, unmoved = float(fit.intrinsics[0, 0]), np.zeros(len(modes))
    start = _core.FaceEstimate([view.head_pose for view in views], focal, unmoved)
    if len(views) > 1:
        observations = [view.observed() for view in views]
        placed = _core.fit_face(model, observations, fit.camera, start=start, shape_free=False)
        poses = [fit.head_pose, *placed.camera_from_head[1:]]
        start = _core.FaceEstimate(poses, focal, unmoved)
    local = [_core.FaceView(_core.local_features(v.measured, len(views))) for v in views]
    estimate = _core.fit_face(model, local, fit.camera, start=start, pose_free=False, elsewhere=1.0)
    if not estimate.converged:
        return fit
    return replace(fit, lines=np.round(estimate.identity, 6).tolist())


def _with_open_eyes(views: list[FittedView]) -> list[FittedView]:
    """The first, and those of the others in which no eye is shut beyond the usual."""
    openings = np.array([_core.eye_openings(view.measured) for view in views])
    usual = np.asarray(np.median(openings, axis=0), np.float64)
    is_open = np.all(openings >= OPEN * usual, axis=1)
    return [view for view, kept in zip(views, is_open, strict=True) if kept or view is views[0]]


def _is_seen(view: FittedView) -> bool:
    return {curve.name for curve in view.measured.curves} >= SEEN_BY_NETWORKS
