# SPDX-License-Identifier: GPL-3.0-or-later
import warnings

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.muscles import anatomy
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import load_template


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.mark.parametrize(
    ("unit", "scale"),
    [("centimetres", 100), ("millimetres", 1000), ("decimetres", 10), ("inches", 1 / 0.0254)],
)
def test_head_in_another_unit_is_refused_with_what_to_do(template, unit, scale):
    with pytest.raises(InvalidInput, match=f"if it is in {unit}, multiply its vertices by"):
        anatomy.attach(template.vertices * scale, template)


@pytest.mark.parametrize("scale", [1e-4, 0, 1e9])
def test_head_of_no_known_unit_is_refused(template, scale):
    with pytest.raises(InvalidInput, match="not in metres; scale it"):
        anatomy.attach(template.vertices * scale, template)


def test_face_without_area_is_named(template):
    mesh = SkinMesh(template, template.vertices)
    vertices = mesh.vertices.copy()
    face = 321
    a, b, _ = mesh.triangles[8 * face]
    vertices[b] = vertices[a]
    with pytest.raises(InvalidInput, match="has no area") as error:
        _core.check_areas(vertices, mesh.triangles, np.repeat(mesh.refinement.parent_face, 2))
    named = int(str(error.value).split()[1])
    assert {a, b} <= set(mesh.triangles[8 * named : 8 * named + 8].ravel())


def test_hole_is_named_and_the_neck_is_none(template):
    mesh = SkinMesh(template, template.vertices)
    _core.check_openings(mesh.triangles, 1, 8)
    torn = np.delete(mesh.triangles, np.s_[8 * 50 : 8 * 51], axis=0)
    with pytest.raises(InvalidInput, match="2 openings, 1 belong there") as error:
        _core.check_openings(torn, 1, 8)
    assert "at face " in str(error.value)


def out_of_place(template, vertex):
    """The head with a vertex pulled far past one of its neighbours, and the faces around it."""
    faces = np.flatnonzero((template.skin_faces == vertex).any(1))
    neighbours = np.setdiff1d(template.skin_faces[faces], [vertex])
    vertices = template.vertices.copy()
    vertices[vertex] += 4 * (vertices[neighbours[0]] - vertices[vertex])
    near = (np.isin(template.skin_faces, template.skin_faces[faces])).any(1)
    return vertices, set(np.flatnonzero(near))


@pytest.mark.parametrize("vertex", [500, 3000])
def test_face_turned_over_is_smoothed_with_a_warning_that_names_it(template, vertex):
    vertices, near = out_of_place(template, vertex)
    with pytest.warns(UserWarning, match="lie turned over") as caught:
        mesh = SkinMesh(template, vertices)
        repaired = mesh.vertices
    named = str(caught[0].message).split("faces ")[1].split(" of the head")[0]
    assert {int(name) for name in named.split(", ")} <= near
    assert not _core.inverted_faces(repaired, mesh.triangles)
    moved = np.linalg.norm(
        repaired - mesh.refinement.positions(vertices[: template.num_skin_vertices]), axis=1
    )
    assert 0 < (moved > 1e-9).sum() < 40  # nothing elsewhere


def test_sound_head_is_left_as_it_is(template):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mesh = SkinMesh(template, template.vertices)
        skin = np.ascontiguousarray(template.vertices[: template.num_skin_vertices])
        assert np.allclose(mesh.vertices, mesh.refinement.positions(skin), rtol=0, atol=1e-12)
