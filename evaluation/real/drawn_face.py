# SPDX-License-Identifier: GPL-3.0-or-later
"""A face of a few soft ellipses, the same pixels wherever it is drawn: to compare networks on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

SIDE = 192  # pixels
ROLL = 0.2  # radians, clockwise in the picture
EDGE = 1.2  # pixels over which an ellipse fades
# From the back to the front, pixels about the middle of the upright face: centre, radii, colour
ELLIPSES = (
    ((0, -8), (56, 74), (52, 38, 30)),
    ((0, 88), (26, 30), (190, 146, 122)),
    ((0, 6), (47, 64), (214, 168, 142)),
    ((-20, -22), (12, 2.4), (70, 48, 36)),
    ((20, -22), (12, 2.4), (70, 48, 36)),
    ((-19, -9), (11, 5.6), (150, 108, 90)),
    ((19, -9), (11, 5.6), (150, 108, 90)),
    ((-19, -8), (9.5, 4), (236, 232, 228)),
    ((19, -8), (9.5, 4), (236, 232, 228)),
    ((-18, -8), (4, 4), (74, 52, 38)),
    ((20, -8), (4, 4), (74, 52, 38)),
    ((-18, -8), (1.8, 1.8), (16, 12, 12)),
    ((20, -8), (1.8, 1.8), (16, 12, 12)),
    ((0, 6), (4.5, 16), (226, 182, 156)),
    ((0, 21), (9, 4.5), (196, 146, 122)),
    ((-4.5, 23), (2.6, 1.5), (96, 60, 50)),
    ((4.5, 23), (2.6, 1.5), (96, 60, 50)),
    ((0, 40), (18, 6.5), (178, 92, 88)),
    ((0, 39.5), (14, 2.6), (66, 24, 26)),
    ((0, 38), (11, 1.4), (228, 220, 210)),
)


def drawn_face() -> NDArray[np.uint8]:
    """SIDE x SIDE x 3, red green blue."""
    y, x = np.mgrid[:SIDE, :SIDE] - 0.5 * (SIDE - 1)
    upright = np.cos(ROLL) * x + np.sin(ROLL) * y, np.cos(ROLL) * y - np.sin(ROLL) * x
    picture = np.full((SIDE, SIDE, 3), (120.0, 132.0, 140.0))
    for center, radii, colour in ELLIPSES:
        u, v = ((upright[i] - center[i]) / radii[i] for i in range(2))
        inside = (1 - np.hypot(u, v)) * min(radii) / EDGE + 0.5  # about 0 to 1 across the edge
        share = np.clip(inside, 0, 1)[..., None]
        picture += share * (np.array(colour, float) - picture)
    shade = 1 - 0.12 * upright[0] / SIDE - 0.1 * (upright[1] / SIDE)
    return np.round(np.clip(picture * shade[..., None], 0, 255)).astype(np.uint8)
