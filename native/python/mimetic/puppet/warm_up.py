# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads beforehand what the first face needs, so that it is shown within a second."""

from __future__ import annotations

import numpy as np

from mimetic.fit import fitting
from mimetic.fit.face_model import face_model
from mimetic.fit.face_shape import face_shape
from mimetic.locate.feature_networks import installed_networks
from mimetic.locate.landmarks import installed_cascade
from mimetic.puppet.live_face import canonical_anatomy
from mimetic.template.face_template import load_template


def warm_up() -> None:
    """Takes two seconds once a process; while a camera starts there is time for it."""
    template = load_template()
    canonical_anatomy()
    installed_cascade()
    installed_networks()
    face_model(template)
    face_shape(template)
    fitting.judge_frame(np.zeros((64, 64, 3), np.uint8))
