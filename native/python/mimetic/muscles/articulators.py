# SPDX-License-Identifier: GPL-3.0-or-later
"""What bone and lids do and skin muscles do not: jaw and eyelids as displacement modes.

A mode is the displacement at value 1; a rotation is taken in full there, so that a closed lid
lies on the eye and an open jaw has not grown. Metres, radians, head frame.
"""

from __future__ import annotations

from mimetic._core import LID_REACH, EyeFrame, EyeLids, Jaw, rotate, smooth_step
from mimetic.skin.mesh import SkinMesh

__all__ = [
    "ARTICULATORS",
    "JAW",
    "LID_REACH",
    "EyeFrame",
    "EyeLids",
    "Jaw",
    "eye_frames",
    "rotate",
    "smooth_step",
]

ARTICULATORS = {  # value range; jaw_side: positive to the subject's left
    "jaw_open": (0.0, 1.0),
    "jaw_side": (-1.0, 1.0),
    "jaw_thrust": (-0.3, 1.0),
    "lid_upper.L": (-1.0, 1.0),
    "lid_lower.L": (-0.3, 1.0),
    "lid_upper.R": (-1.0, 1.0),
    "lid_lower.R": (-0.3, 1.0),
}
JAW = ("jaw_open", "jaw_side", "jaw_thrust")


def eye_frames(mesh: SkinMesh) -> tuple[EyeFrame, EyeFrame]:
    return EyeFrame(mesh, "L"), EyeFrame(mesh, "R")
