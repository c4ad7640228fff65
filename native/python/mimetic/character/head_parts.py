# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyeballs, teeth, tongue and lashes that are meshes of their own, bound together with their head.

The head and its parts are attached as one mesh, the head's vertices first; what that moves of a
part goes back into the part's own frame. What a head wears before its skin, glasses and hats, is
distinguished from them by how both are seen from all sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.placement import to_head, to_object
from mimetic.character.polygons import Polygons
from mimetic.character.shapes import Shape

MOVES = 1e-4  # of the part's extent: by less it is not moved


@dataclass(frozen=True)
class PartMesh:
    """points: V x 3, in its own frame and unit; head_from_part: 4 x 4, to those of the head."""

    points: NDArray[np.float64]
    polygons: Polygons
    head_from_part: NDArray[np.float64]

    def in_head(self) -> NDArray[np.float64]:
        """V x 3 in the head's frame."""
        return _core.placed_points(self.points, self.head_from_part)


def lies_in(head_points: NDArray[np.float64], part: PartMesh) -> bool:
    """Whether a mesh is small beside a head (V x 3, its own frame) and lies inside of its box."""
    return _core.lies_in_box(head_points, part.in_head())


class WornParts:
    """Distinguishes what a head wears from the parts of its face.

    points: V x 3, the head's own frame; metres_from_object: 4 x 4.
    """

    def __init__(
        self,
        points: NDArray[np.float64],
        polygons: Polygons,
        metres_from_object: NDArray[np.float64],
    ) -> None:
        faces, _ = polygons.pieces(points)
        triangles, _ = _core.cut_faces(points, faces)
        self._views = _core.HeadViews(points, triangles, metres_from_object)

    def has(self, part: PartMesh) -> bool:
        return self._views.wears(part.in_head())


def with_parts(
    points: NDArray[np.float64], polygons: Polygons, parts: Sequence[PartMesh]
) -> tuple[NDArray[np.float64], Polygons]:
    """One mesh of a head (V x 3) and its parts, in the head's frame, the head's vertices first."""
    all_points, starts, corners = [points], [polygons.starts], [polygons.corners]
    num_points, num_corners = len(points), len(polygons.corners)
    for part in parts:
        own = _outward(part)
        all_points.append(part.in_head())
        starts.append(own.starts + num_corners)
        corners.append(own.corners + num_points)
        num_points += len(part.points)
        num_corners += len(own.corners)
    return np.concatenate(all_points), Polygons(np.concatenate(starts), np.concatenate(corners))


def shapes_of(
    shapes: Sequence[Shape], num_vertices: int, parts: Sequence[PartMesh]
) -> tuple[list[Shape], list[list[Shape]]]:
    """Shapes of the one mesh as those of the head, of `num_vertices`, and for each part those that
    move it, in its own frame."""
    of_parts, first = [], num_vertices
    for part in parts:
        last = first + len(part.points)
        least = MOVES * float(np.ptp(part.points, axis=0).max())
        moving = []
        for shape in shapes:
            own = _core.moved_in_part(to_object(shape.offsets[first:last]), part.head_from_part)
            if np.abs(own).max(initial=0.0) > least:
                moving.append(replace(shape, offsets=to_head(own)))
        of_parts.append(moving)
        first = last
    return [replace(shape, offsets=shape.offsets[:num_vertices]) for shape in shapes], of_parts


def _outward(part: PartMesh) -> Polygons:
    """The part's polygons; where its frame is a mirror image of the head's, the other way round."""
    starts, corners = (
        np.asarray(a, np.int64) for a in (part.polygons.starts, part.polygons.corners)
    )
    if not _core.is_mirror(part.head_from_part):
        return Polygons(starts, corners)
    ends = np.append(starts[1:], len(corners))
    return Polygons((len(corners) - ends)[::-1].copy(), corners[::-1].copy())
