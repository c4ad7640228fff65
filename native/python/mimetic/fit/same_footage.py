# SPDX-License-Identifier: GPL-3.0-or-later
"""A fit is valid for the clip that it was made from: what was measured there is measured again."""

from __future__ import annotations

import math
import statistics

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit import fitting
from mimetic.fit.face_fit import FaceFit

# Median distance of the features in pupil distances. What the fit makes of them lies up to .1
# beside what was measured; in copies of four clips, encoded again at rate factors 23 to 42, they
# lie up to .05 elsewhere.
MOST_APART = 0.2


def check_same_footage(fit: FaceFit, image: NDArray[np.uint8], clip: str) -> None:
    """Raises InvalidInput unless the face of the fit's frame stands where the fit found it.

    image: H x W x 3 RGB, that frame of the clip; clip: its name, for the message. A copy of the
    clip in another encoding passes. A fit without measured features cannot be checked.
    """
    places = fit.features
    if not {"pupil.L", "pupil.R"} <= places.keys():
        return
    candidate = fitting.judge_frame(image, near=fit.head_place())
    apart = math.inf if candidate is None else _apart(places, candidate.features)
    if apart > MOST_APART:
        raise InvalidInput(
            f"the face fit is of other footage: in frame {fit.frame} of {clip} its face is not "
            "where the fit has it: find the face in this clip (leave the fit out), or take the "
            "clip that the fit was made from"
        )


def _apart(places: dict[str, tuple[float, float]], face: _core.FaceFeatures) -> float:
    distances = [
        math.dist(feature.position, places[feature.name])
        for feature in face.features
        if feature.name in places
    ]
    return statistics.median(distances) / math.dist(places["pupil.L"], places["pupil.R"])
