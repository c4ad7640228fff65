# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks at a fitted head in other frames of its clip, for its relief."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from mimetic import tracking
from mimetic.anatomy import attach_skin, modes_of
from mimetic.face_fit import FaceFit
from mimetic.face_template import load_template
from mimetic.fit import lone_view
from mimetic.footage import Footage
from mimetic.performance import HELD_QUALITY
from mimetic.reference_views import LEAST_TURN, Candidate, turn_signs
from mimetic.relief import LEAST_SIGHTINGS, find_relief
from mimetic.sightings import Sighting


def with_relief(
    footage: Footage,
    fit: FaceFit,
    candidates: Sequence[Candidate],
    progress: Callable[[float, str], bool] | None,
) -> FaceFit:
    """The fit with the relief that the frames tell in which the head is turned otherwise.

    candidates: frames in which the face was found, the fit's among them, expressions allowed. The
    fit as it is where too few are turned, or progress says to stop.
    """
    signs = {c.frame: turn_signs(c.features) for c in candidates}
    turned = {
        c.frame: c.features
        for c in candidates
        if np.linalg.norm(signs[c.frame] - signs[fit.frame]) >= LEAST_TURN
    }
    if len(turned) < LEAST_SIGHTINGS:
        return fit
    template = load_template()
    neutral = fit.neutral_vertices(template)
    anatomy = modes_of(attach_skin(neutral, template, calibration=fit.calibration))
    motion = tracking.face_motion(neutral, template, anatomy)
    reference = footage.read(fit.frame)
    tracker = tracking.make_tracker(reference, fit, template, anatomy, motion)
    at_reference = tracker.advance(reference)
    sightings = []
    for frame, image in footage.frames(min(turned), max(turned)):
        if frame not in turned:
            continue
        if progress and not progress(0.0, f"looking for the face's relief: frame {frame}"):
            return fit
        view = lone_view(frame, image, turned[frame], fit.camera, template)
        if view is None:
            continue
        tracker.restart(reference, at_reference)
        estimate = tracker.advance(image, view.head_pose)
        if not estimate.held and estimate.quality >= HELD_QUALITY:
            sightings.append(Sighting.of(frame, estimate, tracker.observations()))
    modes, std = tracking.moving_modes(anatomy, template.num_skin_vertices)
    return replace(fit, relief=find_relief(fit, template, sightings, modes, std))
