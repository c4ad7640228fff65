# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's head in other footage: the shape is known, where the head is must be found."""

from __future__ import annotations

from dataclasses import replace

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.face_model import face_model
from mimetic.fit.face_shape import face_shape
from mimetic.fit.fitting import LARGEST_ERROR
from mimetic.fit.relief_shift import picture_shifts
from mimetic.template.face_template import FaceTemplate, load_template


def with_shape_of(fit: FaceFit, person: FaceFit) -> FaceFit:
    """The head of `person`, with all that is known of it, in the poses of `fit`."""
    return replace(
        fit,
        identity=dict(person.identity),
        residual=list(person.residual),
        relief=list(person.relief),
        depth=[list(place) for place in person.depth],
        depth_std=list(person.depth_std),
        lines=list(person.lines),
        calibration=person.calibration,
    )


def with_person(fit: FaceFit, person: FaceFit, template: FaceTemplate | None = None) -> FaceFit:
    """The head of `person` where `fit`, of footage that shows the same person, has its own.

    The person's proportions, relief, lines and calibration are kept as they are; the pose in every
    view is solved again, with the camera of `fit`. Raises InvalidInput where that head does not
    fit.
    """
    if not fit.views:
        raise InvalidInput("the face fit is from an older version of Mimetic: fit again")
    template = template or load_template()
    values = face_shape(template).joined(person.identity, person.residual)
    new_fit = with_shape_of(fit, person)
    poses = [view.head_pose for view in fit.views]
    shifts = picture_shifts(new_fit, template, poses)
    observations = [view.observed(shift) for view, shift in zip(fit.views, shifts, strict=True)]
    start = _core.FaceEstimate(poses, float(fit.intrinsics[0, 0]), values)
    model = face_model(template)
    estimate = _core.fit_face(model, observations, fit.camera, start=start, shape_free=False)
    if not estimate.converged or estimate.rms_ipd > LARGEST_ERROR:
        raise InvalidInput(
            "the person's head does not fit the face in this footage: is it the same person?"
        )
    views = [
        replace(view, head_pose=pose)
        for view, pose in zip(fit.views, estimate.camera_from_head, strict=True)
    ]
    return replace(
        new_fit, views=views, head_pose=views[0].head_pose, error=float(estimate.rms_ipd)
    )
