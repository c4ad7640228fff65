# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of an expression at its peak, for lists."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.library.composing import played_by
from mimetic.library.expression import Expression, columns_in
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

SIZE = 256  # pixels
SKIN = (0.80, 0.66, 0.58)
COLOURS = {
    **{"mouth_cavity": (0.42, 0.18, 0.17), "eye_socket": (0.70, 0.50, 0.45)},
    **{"eye": (0.95, 0.95, 0.95), "teeth_upper": (0.93, 0.91, 0.86)},
    **{"teeth_lower": (0.93, 0.91, 0.86), "tongue": (0.72, 0.36, 0.35), "lashes": (-1, -1, -1)},
}
IRIS, IRIS_EDGE = (0.24, 0.28, 0.32), np.cos(np.radians(25))  # off the eye's axis
MARGIN = 1.2  # of the picture's height over the face's


def expression_picture(expression: Expression, person: Performance) -> NDArray[np.uint8]:
    """256 x 256 x 4: a person's head, on transparent ground, with the expression at its peak."""
    still = expression.still()
    values, stds = columns_in(still, [*person.muscles, *person.articulators])
    shown = played_by(person, values, stds, still.fps)
    displacements = shown.surface(0) - person.neutral_vertices
    return head_picture(person.neutral_vertices, displacements, person.faces)


def head_picture(
    neutral: NDArray[np.float64], displacements: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.uint8]:
    """The same of neutral vertices and their displacement (V x 3 each, metres), F x 4 quads."""
    quads = np.ascontiguousarray(faces, dtype=np.int32)
    low, high = neutral.min(axis=0), neutral.max(axis=0)
    options = _core.PortraitOptions()
    options.size = SIZE
    template = load_template()
    colours = np.tile(SKIN, (len(quads), 1))
    if np.array_equal(quads, template.faces):
        colours = _canonical_colours(neutral)
        low[1] = neutral[template.landmark("menton"), 1]
        high[1] = neutral[template.landmark("hairline"), 1]
    options.middle_x = 0.5 * (low[0] + high[0])
    options.middle_y = 0.5 * (low[1] + high[1])
    options.height = MARGIN * (high[1] - low[1])
    return _core.draw_portrait(
        np.ascontiguousarray(neutral + displacements), quads, colours, options
    )


def _canonical_colours(neutral: NDArray[np.float64]) -> NDArray[np.float64]:
    """F x 3 of the canonical head's faces."""
    template = load_template()
    palette = [COLOURS.get(name.split(".")[0], SKIN) for name in template.part_names]
    colours = np.array(palette, dtype=np.float64)[template.part]
    centres, radius = template.eye_spheres(neutral)
    for side, centre in zip("LR", centres, strict=True):
        faces = template.part_faces(f"eye.{side}")
        middles = neutral[template.faces[faces]].mean(axis=1)
        colours[faces[(middles - centre)[:, 2] > IRIS_EDGE * radius]] = IRIS
    return colours
