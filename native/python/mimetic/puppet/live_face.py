# SPDX-License-Identifier: GPL-3.0-or-later
"""A person as a live filter follows them: the head, what moves it, a tracker of cheap frames."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.locate.feature_networks import installed_networks
from mimetic.muscles.anatomy import Anatomy, attach_skin, modes_of
from mimetic.muscles.extras import with_lip_shapes
from mimetic.muscles.eyeballs import EyeGeometry, eye_geometry
from mimetic.performance.gaze import GAZE
from mimetic.solve import tracking
from mimetic.solve.gaze import FACING, gaze_in
from mimetic.template.face_template import FaceTemplate, load_template

# What a frame of 30 a second can afford on two laptop cores: half the time of it is the networks'
# at eyes and lips, which look every frame.
CROP_HEIGHT, SAMPLE_SPACING, ITERATIONS, KEY_VIEWS = 140, 4, 2, 3


@dataclass
class LiveFace:
    """A fitted head with what moves it, and the tracker that follows it from the fit's picture."""

    fit: FaceFit
    template: FaceTemplate
    anatomy: Anatomy
    eyes: EyeGeometry
    tracker: _core.FaceTracker
    gaze: _core.GazeFilter
    lids: list[_core.LidFollowing]  # the upper ones, which the fit has as they are at its gaze
    is_own: bool  # the muscles are attached to this head, not carried over from the canonical one

    @property
    def camera(self) -> _core.Camera:
        return self.fit.camera


def live_face(
    image: NDArray[np.uint8], fit: FaceFit, anatomy: Anatomy | None = None, is_own: bool = False
) -> LiveFace:
    """The face of a picture (H x W x 3) that the head was fitted to.

    anatomy: `own_anatomy` of this head, or of another; otherwise the canonical head's muscles are
    carried over, vertex by vertex.
    """
    template = load_template()
    neutral = fit.neutral_vertices(template)
    if anatomy is None:
        anatomy = canonical_anatomy().extended_by(fit.calibration)
    motion = tracking.face_motion(
        neutral, template, anatomy, neutral_depth_std=fit.neutral_depth_std(template)
    )
    tracker = tracking.make_tracker(image, fit, template, anatomy, motion, live_options())
    eyes = eye_geometry(neutral, template)
    balls = _core.Eyeballs(eyes.centers, eyes.radii, FACING)
    gaze = _core.GazeFilter(balls)
    pitches = gaze_in(gaze, fit.camera, tracker.advance(image, None), 0.0)[1::2].tolist()
    lids = [
        _core.LidFollowing(per_degree, pitch)
        for per_degree, pitch in zip(eyes.lid_per_degree, pitches, strict=True)
    ]
    return LiveFace(fit, template, anatomy, eyes, tracker, gaze, lids, is_own)


def own_anatomy(fit: FaceFit) -> Anatomy:
    """Muscles attached to a fitted head, which takes most of a second, as far as they go there."""
    template = load_template()
    neutral = fit.neutral_vertices(template)
    return _attached(neutral, template, fit).extended_by(fit.calibration)


def live_options() -> _core.TrackerOptions:
    options = _core.TrackerOptions()
    options.crop_height, options.sample_spacing = CROP_HEIGHT, SAMPLE_SPACING
    options.max_iterations, options.max_key_views = ITERATIONS, KEY_VIEWS
    return options


@cache
def canonical_anatomy() -> Anatomy:
    """What moves the canonical head; it takes a second the first time."""
    template = load_template()
    return _attached(np.asarray(template.vertices, dtype=np.float64), template, None)


def live_names() -> list[str]:
    """Of a live state's values: muscles, articulators, then the gaze's four angles."""
    anatomy = canonical_anatomy()
    return [*anatomy.muscle_names, *anatomy.articulator_names, *GAZE]


def _attached(neutral: NDArray[np.float64], template: FaceTemplate, fit: FaceFit | None) -> Anatomy:
    skin = attach_skin(neutral, template, calibration=fit.calibration if fit else None)
    anatomy = modes_of(skin)
    return with_lip_shapes(anatomy, skin) if installed_networks() else anatomy
