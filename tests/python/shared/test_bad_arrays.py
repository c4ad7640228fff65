# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays that do not fit each other are refused by the core, in a process of its own: what reads
beyond an array ends it."""

import subprocess
import sys

import pytest

PREPARED = """
import numpy as np
from mimetic import InvalidInput, _core
points = np.random.default_rng(0).normal(size=(4, 3))
picture = np.zeros((24, 32, 3), np.uint8)
def triangle(vertex): return np.array([[0, 1, vertex]], np.int32)
def quad(vertex): return np.array([[0, 1, 2, vertex]], np.int32)
try:
    {case}
except InvalidInput as error:
    print("refused:", error)
"""

CASES = [
    *(f"_core.inverted_faces(points, triangle({vertex}))" for vertex in (-1, 4, 10**7)),
    *(f"_core.split_quads(points, quad({vertex}))" for vertex in (-(10**7), 4)),
    *(f"_core.faces_in_view(points, quad({vertex}))" for vertex in (-1, 4, 10**7)),
    *(f"_core.quad_normals(points, quad({vertex}))" for vertex in (-1, 4)),
    "_core.check_areas(points, triangle(10**7), np.zeros(1, np.int32))",
    "_core.check_openings(triangle(-(10**7)), 1)",
    "_core.guess_places(np.eye(3), np.eye(3), np.zeros((1, 3)), 10**6)",
    "_core.lid_slit(np.eye(3), [10**8], np.zeros((2, 3)), 0.5)",
    "_core.lid_slit(np.eye(3), [0], np.zeros((1, 3)), 0.5)",
    "_core.principal_shapes(np.zeros((0, 3)), [0], 100)",
    "_core.principal_shapes(np.zeros((2, 3)), [1], 2)",
    "_core.landmark_descriptors(picture, np.ones((2, 2)), np.zeros((0, 2)), 0.2)",
    "_core.landmark_descriptors(picture, np.full((2, 2), 1e12), np.ones((2, 2)), 0.2)",
    "_core.landmark_descriptors(picture, np.full((2, 2), np.nan), np.eye(2), 0.2)",
    "_core.marks_of(np.zeros((0, 3)), 8)",
    "_core.world_from_moved_head(points, [0], [0, 1, 9], np.ones(4), np.eye(4))",
    "_core.world_from_moved_head(points, [], [], np.ones(3), np.eye(4))",
]


@pytest.mark.parametrize("case", CASES)
def test_is_refused(case):
    run = subprocess.run(
        [sys.executable, "-c", PREPARED.format(case=case)], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.startswith("refused:")
