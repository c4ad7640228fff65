# SPDX-License-Identifier: GPL-3.0-or-later
"""Where pictures show the face of a head whose pose is known."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.locate.feature_networks import feature_anchors
from mimetic.template.face_template import load_template


class FacePlace:
    """The square of the picture that a fitted head's face is in."""

    def __init__(self, fit: FaceFit) -> None:
        template = load_template()
        self._camera = fit.camera
        self._anchors = feature_anchors(fit.neutral_vertices(template), template)

    def at(self, head_pose: NDArray[np.float64]) -> _core.FeatureCrop | None:
        """Of a head at a pose (4 x 4, camera from head); None where it is not before the camera."""
        try:
            return _core.feature_crops(self._camera, head_pose, self._anchors).face
        except InvalidInput:
            return None
