# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact of a face whose shapes are set by hand, fast enough to follow a slider.

Arrays are in the object's frame (`placement`), metres, as the face's object has them.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.character.live_face import template_rest
from mimetic.character.placement import OBJECT_FROM_HEAD
from mimetic.muscles.contact import contact_on


class LiveContact:
    """What lips and lids of a face do to each other; moved: W vertices that it can displace.

    contact: in the object's frame; num_vertices: those from there on are not of the face itself.
    """

    def __init__(self, contact: _core.SkinContact, num_vertices: int | None = None):
        self._contact = contact
        moved = np.asarray(contact.moved)
        self._is_own = np.ones(len(moved), bool) if num_vertices is None else moved < num_vertices
        self.moved = moved[self._is_own]

    def correction(
        self, moves: Iterable[tuple[float, NDArray, NDArray]]
    ) -> NDArray[np.float32] | None:
        """Displacement of `moved`, W x 3, that parts lips and lids; None if nothing touches.

        moves: value, points and points at value 0 (V x 3 each) of every shape that is not at 0.
        """
        vertices = self._contact.vertices
        offset = np.zeros((len(vertices), 3))
        for value, points, start in moves:
            offset += value * (points[vertices] - start[vertices])
        correction = self._contact.correction(offset)
        return None if correction is None else correction[self._is_own]

    def of_first(self, num_vertices: int) -> LiveContact:
        """The same of a head whose parts, behind its own vertices, are objects of their own."""
        return LiveContact(self._contact, num_vertices)


def live_contact(rest_points: ArrayLike) -> LiveContact:
    """Of a face of the template's mesh, V x 3 at rest; takes a second or two the first time.

    Raises InvalidInput if that is another mesh or one that muscles cannot be attached to.
    """
    contact = contact_on(template_rest(rest_points))
    return LiveContact(contact.turned(OBJECT_FROM_HEAD[:3, :3]))
