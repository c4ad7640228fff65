# SPDX-License-Identifier: GPL-3.0-or-later
"""ARKit's face units of a live state: the fit that tables and files are made by, on the canonical
head."""

from __future__ import annotations

from functools import cache

import numpy as np

from mimetic.puppet.live_face import canonical_anatomy, live_names
from mimetic.retarget.unit_fit import UnitFit
from mimetic.template.face_template import load_template


@cache
def live_units() -> UnitFit:
    """Of values as `live_names` has them."""
    anatomy = canonical_anatomy()
    limits = np.asarray(anatomy.articulator_limits, dtype=np.float64)
    return UnitFit(
        live_names(),
        load_template().vertices,
        np.concatenate([anatomy.muscle_modes, anatomy.articulator_modes]),
        np.concatenate([np.tile([0.0, 1.0], (len(anatomy.muscle_names), 1)), limits]),
    )
