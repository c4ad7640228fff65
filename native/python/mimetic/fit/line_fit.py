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

SEEN_BY_NETWORKS = "lid_upper.L"  # a line that nothing else sees


def with_lines(fit: FaceFit, others: Sequence[FittedView], template: FaceTemplate) -> FaceFit:
    """The fit with lids and lips as seen in its reference frame, and in others at rest.

    The fit as it is where the networks saw nothing in the reference frame.
    """
    if not fit.views or not _is_seen(fit.views[0]):
        return fit
    views = [fit.views[0], *filter(_is_seen, others)]
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


def _is_seen(view: FittedView) -> bool:
    return any(curve.name == SEEN_BY_NETWORKS for curve in view.measured.curves)
