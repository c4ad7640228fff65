# SPDX-License-Identifier: GPL-3.0-or-later
"""What the mirror makes of muscles, articulators and shapes: their names and their signs."""

from __future__ import annotations

LEFT, RIGHT = ".L", ".R"
# Positive to the subject's left: the mirror turns the sign
TURNED = ("jaw_side", "gaze_yaw", "eye_left", "eye_down_left")
EYE_TURNS = ("gaze_", "eye_", "look_")  # how names of what turns an eye begin


def mirrored_name(name: str) -> str:
    """Of the muscle, articulator or shape at the same place on the other side."""
    for side, other in ((LEFT, RIGHT), (RIGHT, LEFT)):
        if name.endswith(side):
            return name.removesuffix(side) + other
    return name


def mirrored_sign(name: str) -> float:
    """What a value is multiplied by when it changes sides."""
    return -1.0 if name.removesuffix(LEFT).removesuffix(RIGHT) in TURNED else 1.0
