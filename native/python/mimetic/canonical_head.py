# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head with its muscles, as a character to animate by hand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic.anatomy import attach
from mimetic.appearance import Appearance, painted
from mimetic.face_template import load_template
from mimetic.shapes import Shape, group_shapes, shapes_of_anatomy


@dataclass(frozen=True)
class Head:
    """A head at rest: metres, head frame."""

    vertices: NDArray[np.float64]  # V x 3
    faces: NDArray[np.int32]  # F x 4
    shapes: list[Shape]  # muscles, jaw and lids
    groups: list[Shape]  # sliders of groups of muscles
    appearance: Appearance


@lru_cache(maxsize=1)
def make_head() -> Head:
    """The head that every fit starts from, with what moves it and how it looks; made once."""
    template = load_template()
    anatomy = attach(template.vertices, template)
    return Head(
        template.vertices,
        template.faces,
        shapes_of_anatomy(anatomy),
        group_shapes(anatomy.muscle_names, anatomy.groups, anatomy.muscle_modes),
        painted(template),
    )
