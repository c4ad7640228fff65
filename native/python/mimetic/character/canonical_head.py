# SPDX-License-Identifier: GPL-3.0-or-later
"""The canonical head with its muscles, as a character to animate by hand."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic.character.appearance import Appearance, painted
from mimetic.character.shapes import Shape, group_shapes, shapes_of_anatomy, shapes_of_extras
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.muscles.extras import attach_extras
from mimetic.template.face_template import load_template


@dataclass(frozen=True)
class Head:
    """A head at rest: metres, head frame."""

    vertices: NDArray[np.float64]  # V x 3
    faces: NDArray[np.int32]  # F x 4
    shapes: list[Shape]  # muscles, jaw and lids, extras
    groups: list[Shape]  # sliders of groups of muscles
    appearance: Appearance


@lru_cache(maxsize=1)
def make_head() -> Head:
    """The head that every fit starts from, with what moves it and how it looks; made once."""
    template = load_template()
    skin = attach_skin(template.vertices, template)
    anatomy = modes_of(skin)
    return Head(
        template.vertices,
        template.faces,
        [*shapes_of_anatomy(anatomy), *shapes_of_extras(attach_extras(skin))],
        group_shapes(anatomy.muscle_names, anatomy.groups, anatomy.muscle_modes),
        painted(template),
    )
