# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of the canonical head's skin that pictures show sharply: lids' margins and lips' edges.

Each is a list of control vertices from corner to corner and has the name of the landmark on it.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mimetic import _core
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.skin.mesh import canonical_skin
from mimetic.template.face_template import FaceTemplate

LIPS = ("lip_upper", "lip_lower")
ON_MIDLINE = 1e-6  # metres


@lru_cache(maxsize=2)
def feature_lines(template: FaceTemplate) -> dict[str, list[int]]:
    """`lid_upper.L`, ... from the outer to the inner corner; `lip_upper`, `lip_lower` round the
    red, `lip_upper_inner`, `lip_lower_inner` where the lips part, from the subject's right to left.
    """
    lines = {}
    for frame in eye_frames(canonical_skin(template)):
        lids = EyeLids(frame)
        for name, margin in (("lid_upper", lids.upper), ("lid_lower", lids.lower)):
            outward = sorted(map(int, margin), key=lambda v: -abs(template.vertices[v, 0]))
            lines[f"{name}.{frame.side}"] = outward
    middles = [template.landmark(name) for name in LIPS]
    lines["lip_upper"], lines["lip_lower"] = _parted_loop(template, *middles)
    inner = [_rolled_in(template, template.landmark(f"{name}_inner")) for name in LIPS]
    lines["lip_upper_inner"], lines["lip_lower_inner"] = _parted_loop(template, *inner)
    return lines


def _rolled_in(template: FaceTemplate, vertex: int) -> int:
    """The next vertex of the midline towards the teeth: closed lips are seen to meet there."""
    points = template.vertices
    middle = [v for v in _neighbours(template, vertex) if abs(points[v, 0]) < ON_MIDLINE]
    return min(middle, key=lambda v: points[v, 2])


def _parted_loop(template: FaceTemplate, upper: int, lower: int) -> tuple[list[int], list[int]]:
    """The loop of edges about the mouth through two vertices of the midline, parted at its ends."""
    x = template.vertices[:, 0]
    lips = []
    for middle, other in ((upper, lower), (lower, upper)):
        leftmost = max(_neighbours(template, middle), key=lambda v: x[v])
        loop = _core.edge_loop(template.skin_faces, middle, leftmost)
        half = loop[: loop.index(other)]
        half = half[: int(np.argmax(x[half])) + 1]
        lips.append([int(template.mirror[v]) for v in reversed(half[1:])] + half)
    return lips[0], lips[1]


def _neighbours(template: FaceTemplate, vertex: int) -> list[int]:
    quads, corners = np.nonzero(template.skin_faces == vertex)
    both = template.skin_faces[np.r_[quads, quads], np.r_[corners - 1, (corners + 1) % 4]]
    return sorted(set(both.tolist()))
