# SPDX-License-Identifier: GPL-3.0-or-later
"""What lies on and in a foreign head besides its skin: teeth, eyes, lashes, hair.

A loose part is what most of it lies nearest to on the template laid onto the head: lower teeth and
tongue go with the jaw, upper teeth and eyes stay, what lies close to the skin follows it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.muscles.anatomy import SIDES
from mimetic.skin.closest_points import nearest

NEAR_SKIN = 0.008  # m at the template's size: lashes, brows, beards
SAMPLES = 16  # vertices of a part that tell what it is
MAX_FOLLOWING = 50_000
ON_JAW = ("teeth_lower", "tongue")
STILL = ("teeth_upper", "eye.L", "eye.R")


class LooseParts:
    """on_jaw: V, which of the caller's vertices are fixed to the lower jaw; eyes: by side, V, which
    belong to the eyeball; following: K vertices that go where the skin's vertex in `roots` (K)
    goes; notes."""

    def __init__(self, skin: ForeignSkin, laid_vertices: NDArray[np.float64], template):
        loose = skin.loose
        self.on_jaw = np.zeros(len(loose), bool)
        self.eyes = {side: np.zeros(len(loose), bool) for side in SIDES}
        self.following = self.roots = np.zeros(0, np.int64)
        self.notes: tuple[str, ...] = ()
        vertices = np.flatnonzero(loose >= 0)
        if not len(vertices):
            return
        labels, number, counts = np.unique(loose[vertices], return_inverse=True, return_counts=True)
        sample = vertices[_few_of_each(number, counts)]
        part = np.searchsorted(labels, loose[sample])
        points = skin.user_vertices[sample]
        like = _part_of_vertices(template)[nearest(points, laid_vertices)]
        jaw, still, *eyes = (
            np.isin(like, _indices(template, names))
            for names in (ON_JAW, STILL, *((f"eye.{side}",) for side in SIDES))
        )
        root = skin.vertices[nearest(points, skin.vertices)]
        near = np.linalg.norm(points - root, axis=1) < NEAR_SKIN

        def mostly(flags):
            return 2 * np.bincount(part, flags, len(labels)) > np.bincount(part, None, len(labels))

        jaw, still, near = mostly(jaw), mostly(still), mostly(near)
        self.on_jaw[vertices] = jaw[number]
        for side, eye in zip(SIDES, eyes, strict=True):
            self.eyes[side][vertices] = mostly(eye)[number]
        following = vertices[(near & ~jaw & ~still)[number]]
        if len(following) > MAX_FOLLOWING:
            self.notes = (
                f"{len(following)} loose vertices near to the skin are too many: they stay",
            )
            return
        self.following = following
        self.roots = nearest(skin.user_vertices[following], skin.vertices)


def _few_of_each(number: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Indices into `number` (which part each is of): some SAMPLES of every part."""
    order = np.argsort(number, kind="stable")
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    rank = np.arange(len(number)) - np.repeat(starts, counts)
    step = np.repeat(-(-counts // SAMPLES), counts)
    return order[rank % step == 0]


def _part_of_vertices(template) -> NDArray[np.int64]:
    part = np.zeros(len(template.vertices), np.int64)
    part[template.faces] = np.asarray(template.part)[:, None]
    return part


def _indices(template, names) -> list[int]:
    return [list(template.part_names).index(name) for name in names]
