# SPDX-License-Identifier: GPL-3.0-or-later
"""Action units of FACS as kept expressions: straight up, held, straight down, as FACS animates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.library.expression import Expression
from mimetic.library.preview import head_picture
from mimetic.muscles.action_units import UNSIDED, action_unit, unit_meanings
from mimetic.template.face_template import load_template

FPS = 60.0
RISE, HOLD, FALL = 0.4, 0.4, 0.4  # seconds


def unit_expression(name: str) -> Expression:
    """A unit's linear ramp to intensity 1 on both sides."""
    channels = [name] if name in UNSIDED else [f"{name}.L", f"{name}.R"]
    seconds = np.arange(round((RISE + HOLD + FALL) * FPS) + 1) / FPS
    ramp = np.interp(seconds, np.cumsum([0, RISE, HOLD, FALL]), [0.0, 1, 1, 0])
    values = np.tile(np.asarray(ramp, dtype=np.float64)[:, None], (1, len(channels)))
    rows = FPS * np.array([[0.0, RISE, RISE + HOLD, 1 / FPS]])
    source = ["FACS", unit_meanings()[name]]
    return Expression(channels, values, np.zeros_like(values), FPS, [name], rows, source)


def unit_picture(name: str) -> NDArray[np.uint8]:
    """256 x 256 x 4: our head with the unit at intensity 1."""
    template = load_template()
    unit = action_unit(name, template.vertices, template)
    return head_picture(template.vertices, unit.mode, template.faces.astype(np.int64))
