# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on and in a foreign head besides its skin: teeth, eyes, lashes, hair.

A loose part is what most of it lies nearest to on the registered template: lower teeth and
tongue go with the jaw, upper teeth and eyes stay, what lies close to the skin follows it. What lies
around an eyeball's middle as its surface does is an eyeball, however finely it is meshed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.muscles.anatomy import SIDES
from mimetic.muscles.eyeballs import limit_of
from mimetic.template.face_template import FaceTemplate

PARTS = {
    "teeth_lower": _core.TemplatePart.lower_jaw,
    "tongue": _core.TemplatePart.lower_jaw,
    "teeth_upper": _core.TemplatePart.upper_teeth,
    "eye.L": _core.TemplatePart.left_eye,
    "eye.R": _core.TemplatePart.right_eye,
}


class LooseParts:
    """on_jaw: V, which of the caller's vertices are fixed to the lower jaw; eyes: by side, V, which
    belong to the eyeball; ball_centres: by side, (3,) of an eyeball that is modelled in full, or
    None; following: K vertices that go where the skin's vertex in `roots` (K) goes; notes."""

    def __init__(
        self, skin: ForeignSkin, laid_vertices: NDArray[np.float64], template: FaceTemplate
    ):
        part = np.full(len(template.vertices), int(_core.TemplatePart.other), np.int32)
        for name, like in PARTS.items():
            part[template.part_vertices(name)] = int(like)
        laid = np.array(laid_vertices, dtype=np.float64)
        for side in SIDES:
            # The control vertices of so coarse a ball lie far outside of it
            ball = template.part_vertices(f"eye.{side}")
            laid[ball] = limit_of(laid, template, ball)
        parts_by_kind = _core.sort_loose_parts(skin.mesh, laid, part)
        self.on_jaw = parts_by_kind.on_jaw
        self.eyes = {side: parts_by_kind.on_eye(number) for number, side in enumerate(SIDES)}
        self.ball_centres = {
            side: parts_by_kind.ball_centre(number) for number, side in enumerate(SIDES)
        }
        self.following, self.roots = parts_by_kind.following, parts_by_kind.roots
        self.notes: tuple[str, ...] = ()
        if parts_by_kind.num_left:
            self.notes = (
                f"{parts_by_kind.num_left} loose vertices near to the skin are too many: they stay",
            )

    def eye_of_vertex(self) -> NDArray[np.int32]:
        """V: 1 of the left eyeball, 2 of the right, 0 of all else."""
        number = np.zeros(len(self.on_jaw), np.int32)
        for eye, side in enumerate(SIDES):
            number[self.eyes[side]] = eye + 1
        return number
