# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves in a clip's frames, seen from one of them that may not be at rest.

Muscles may go below 0 here: what was contracted in the first frame relaxes in others. Proportions
that look unusual are an expression where other frames leave it, and the person's own where they
do not.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mimetic.fit.face_fit import FaceFit
from mimetic.media.backward import frames_away
from mimetic.media.cuts import of_one_scene
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import AttachedSkin, modes_of
from mimetic.performance.document import HELD_QUALITY
from mimetic.solve import tracking
from mimetic.template.face_template import load_template

LOWEST = -1.0  # activation: as far below the supposed rest as muscles go above it
JAW = "jaw_open"


def values_from(
    footage: Footage, fit: FaceFit, frames: set[int], skin: AttachedSkin
) -> Iterator[tuple[int, NDArray[np.float64]]]:
    """Muscles and jaw in those of `frames` to which the face can be followed from the fit's frame.

    The fit's own is the first. skin: of the fit's head.
    """
    template = load_template()
    anatomy = modes_of(skin)
    neutral = fit.neutral_vertices(template)
    motion = tracking.face_motion(neutral, template, anatomy, lowest=LOWEST)
    reference = footage.read(fit.frame)
    tracker = tracking.make_tracker(reference, fit, template, anatomy, motion)
    num_muscles = len(anatomy.muscle_names)
    told = [*range(num_muscles), num_muscles + list(anatomy.articulator_names).index(JAW)]
    at_reference = tracker.advance(reference)
    yield fit.frame, at_reference.values[told]
    for end in {min(frames), max(frames)} - {fit.frame}:
        tracker.restart(reference, at_reference)
        images = frames_away(footage, fit.frame, end)
        for frame, image in of_one_scene(reference, images):
            if frame not in frames:
                continue
            estimate = tracker.advance(np.ascontiguousarray(image))
            if not estimate.held and estimate.quality >= HELD_QUALITY:
                yield frame, estimate.values[told]
