# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyeballs and teeth that are meshes of their own, as one mesh with their head and back."""

import numpy as np
import pytest
from mimetic.character.foreign_face import Polygons
from mimetic.character.head_parts import PartMesh, lies_in, shapes_of, with_parts
from mimetic.character.placement import to_head, to_object
from mimetic.character.shape import Shape

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TETRAHEDRON = Polygons(np.array([0, 3, 6, 9]), np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]))


def volume(points: np.ndarray, polygons: Polygons) -> float:
    """Of a closed mesh of triangles; negative where they look inwards."""
    corners = points[np.asarray(polygons.corners).reshape(-1, 3)]
    return float(np.linalg.det(corners).sum() / 6)


def part(scale=(1.0, 1.0, 1.0), place=(0.0, 0.0, 0.0)) -> PartMesh:
    matrix = np.diag([*scale, 1.0])
    matrix[:3, 3] = place
    return PartMesh(CORNERS, TETRAHEDRON, matrix)


@pytest.mark.parametrize("scale", [(0.5, 0.5, 0.5), (-0.5, 0.5, 0.5)])
def test_parts_follow_the_heads_vertices_and_look_outwards(scale):
    points, polygons = with_parts(10 * CORNERS, TETRAHEDRON, [part(scale, (3, 2, 1))])
    assert len(points) == 8
    np.testing.assert_allclose(points[4:], CORNERS * scale + (3, 2, 1))
    assert polygons.starts.tolist() == list(range(0, 24, 3))
    own = Polygons(np.arange(0, 12, 3), polygons.corners[12:] - 4)
    assert volume(points[4:] - (3, 2, 1), own) == pytest.approx(0.5**3 / 6)


def test_shapes_come_back_in_each_parts_own_frame():
    turned = part((0.5, 0.5, 0.5))
    turned.head_from_part[:3, :3] = 0.5 * np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    offsets = np.zeros((8, 3))
    offsets[4:] = (0.1, 0, 0)
    moving = Shape("gaze", "Gaze", to_head(offsets), np.zeros(0), 0.0, 1.0)
    still = Shape("brow", "Brow", to_head(1e-9 * offsets), np.zeros(0), 0.0, 1.0)
    own, (of_part,) = shapes_of([moving, still], 4, [turned])
    assert [len(shape.offsets) for shape in own] == [4, 4]
    assert [shape.name for shape in of_part] == ["gaze"]
    np.testing.assert_allclose(to_object(of_part[0].offsets), np.tile((0, -0.2, 0), (4, 1)))


def test_only_what_is_small_and_inside_is_a_part():
    head = 10 * CORNERS
    assert lies_in(head, part(place=(1, 1, 1)))
    assert not lies_in(head, part(place=(9.5, 1, 1)))
    assert not lies_in(head, part((6.0, 6.0, 6.0)))
