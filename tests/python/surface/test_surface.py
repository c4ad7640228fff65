# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput, _core

CUBE_FACES = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]], np.int32
)
CUBE_VERTICES = np.array(
    [[(i & 1) * 2 - 1, (i >> 1 & 1) * 2 - 1, (i >> 2) * 2 - 1] for i in range(8)], float
)


def test_stencils_are_the_positions():
    mesh = _core.SubdividedMesh(CUBE_FACES, 8, 2)
    stencils = mesh.stencils()
    indptr, indices, weights = stencils.indptr, stencils.indices, stencils.weights
    assert (len(stencils), stencils.num_columns) == (mesh.num_refined, 8)
    np.testing.assert_allclose(
        stencils.multiply(CUBE_VERTICES), mesh.positions(CUBE_VERTICES), atol=1e-12
    )
    positions = mesh.positions(CUBE_VERTICES)
    assert mesh.faces.shape == (96, 4)
    assert mesh.parent_face.tolist() == np.repeat(np.arange(6), 16).tolist()
    for row in range(mesh.num_refined):
        own = slice(indptr[row], indptr[row + 1])
        np.testing.assert_allclose(
            weights[own] @ CUBE_VERTICES[indices[own]], positions[row], atol=1e-12
        )


@pytest.mark.parametrize(
    ("indptr", "indices", "weights", "columns"),
    [
        ([0, 2], [0], [1.0], 4),
        ([0, 1], [4], [1.0], 4),
        ([0, 1], [-1], [1.0], 4),
        ([0, 1], [0], [1.0, 2.0], 4),
        ([0, 2, 1, 2], [0, 1], [1.0, 1.0], 4),
        ([], [], [], 4),
        ([0], [], [], 0),
    ],
)
def test_rows_that_are_no_matrix_are_refused(indptr, indices, weights, columns):
    with pytest.raises(InvalidInput, match="no matrix of compressed rows"):
        _core.CompressedRows(indptr, indices, weights, columns)


def test_rows_are_multiplied_with_as_many_values_as_they_have_columns():
    rows = _core.CompressedRows([0, 2, 2, 3], [0, 2, 1], [0.5, 2.0, -1.0], 3)
    values = np.array([[2.0, 1.0], [3.0, 0.0], [4.0, -1.0]])
    np.testing.assert_allclose(rows.multiply(values), [[9, -1.5], [0, 0], [-3, 0]])
    with pytest.raises(InvalidInput, match="4 rows of values for 3 columns"):
        rows.multiply(np.ones((4, 1)))


def test_face_centre_points_outwards():
    surface = _core.LimitSurface(CUBE_FACES, 8, np.arange(6, dtype=np.int32), np.full((6, 2), 0.5))
    positions = surface.positions(CUBE_VERTICES)
    normals = surface.normals(CUBE_VERTICES)
    np.testing.assert_allclose(
        normals, positions / np.linalg.norm(positions, axis=1)[:, None], atol=1e-12
    )


def test_wrong_type_is_refused_rather_than_copied():
    with pytest.raises(TypeError):
        _core.SubdividedMesh(CUBE_FACES.astype(np.int64), 8, 1)


def test_bad_mesh_is_a_value_error_and_prints_nothing(capfd):
    faces = CUBE_FACES.copy()
    faces[4, 2] = 99
    with pytest.raises(ValueError, match="face 4 names vertex 99"):
        _core.SubdividedMesh(faces, 8, 1)
    assert capfd.readouterr() == ("", "")
