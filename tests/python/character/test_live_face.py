# SPDX-License-Identifier: GPL-3.0-or-later
"""Sliders of groups, muscles as lines on the face, strain of its skin."""

import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.character.live_face import LiveFace
from mimetic.character.muscle_lines import LIFT, MuscleLines, find_on_skin
from mimetic.character.placement import to_head, to_object
from mimetic.character.shapes import GROUPS, group_shapes, shapes_of_anatomy
from mimetic.character.strain_map import FAINTEST, STRONGEST, scale_strip, strain_colours
from mimetic.muscles.anatomy import AnatomyPerturbation, attach, place_muscles
from mimetic.skin.mesh import SkinMesh, multiply
from mimetic.template.face_template import load_template

SINGLE_PRECISION = 1e-6  # metres, of a head 0.3 m high


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def anatomy(template):
    return attach(template.vertices, template)


@pytest.fixture(scope="module")
def mesh(template):
    return SkinMesh(template, np.ascontiguousarray(template.vertices))


@pytest.fixture(scope="module")
def lines(mesh):
    return MuscleLines(mesh)


@pytest.fixture(scope="module")
def rest(template):
    return to_object(template.vertices)


@pytest.fixture(scope="module")
def face(rest):
    return LiveFace(rest)


def refine(mesh, vertices):
    return multiply(mesh.stencils, vertices[: mesh.template.num_skin_vertices])


def test_a_group_is_the_sum_of_its_muscles_and_of_its_sides(anatomy):
    groups = group_shapes(anatomy.muscle_names, anatomy.groups, anatomy.muscle_modes)
    by_name = {shape.name: shape for shape in groups}
    assert len(by_name) == 3 * len(GROUPS)
    for group, name in GROUPS.items():
        members = anatomy.muscle_modes[anatomy.groups == group].sum(axis=0)
        np.testing.assert_allclose(by_name[name].offsets, members, atol=1e-12)
        sides = by_name[f"{name}.L"].offsets + by_name[f"{name}.R"].offsets
        np.testing.assert_allclose(sides, members, atol=1e-12)
        assert by_name[name].lowest == -1
        assert len(by_name[name].values) == 0


def test_muscles_that_have_no_side_are_in_no_side_slider():
    modes = np.ones((2, 4, 3))
    assert [s.name for s in group_shapes(["a", "b.L"], [1, 1], modes)] == [
        "Lip Corners",
        "Lip Corners.L",
    ]


def test_a_head_at_rest_has_all_shapes_in_their_groups(anatomy):
    shapes = shapes_of_anatomy(anatomy)
    assert [s.name for s in shapes] == [*anatomy.muscle_names, *anatomy.articulator_names]
    assert {s.group for s in shapes[:36]} == set(GROUPS.values())
    jaw_thrust = next(s for s in shapes if s.name == "jaw_thrust")
    assert (jaw_thrust.lowest, jaw_thrust.highest) == (pytest.approx(-0.3), 1)


def test_points_on_the_skin_are_found_where_they_are(mesh):
    random = np.random.default_rng(0)
    outer = mesh.triangles[mesh.triangle_part == "skin"]
    chosen = outer[random.choice(len(outer), 300)]
    weights = random.dirichlet(np.ones(3), 300)
    points = np.einsum("pk,pkx->px", weights, mesh.vertices[chosen])
    places = find_on_skin(mesh, points).positions(mesh.vertices)
    assert np.linalg.norm(places - points, axis=1).max() < 1e-9


def test_what_lies_off_the_skin_is_laid_on_its_nearest_point(mesh):
    """Against all triangles, one by one, for a few points."""
    random = np.random.default_rng(1)
    outer = mesh.triangles[mesh.triangle_part == "skin"]
    points = mesh.vertices[random.choice(np.unique(outer), 12)] + random.normal(0, 0.002, (12, 3))
    places = find_on_skin(mesh, points).positions(mesh.vertices)
    grid = np.array([(i, j, 20 - i - j) for i in range(21) for j in range(21 - i)]) / 20
    for point, nearest in zip(points, places, strict=True):
        around = outer[np.linalg.norm(mesh.vertices[outer[:, 0]] - point, axis=1) < 0.03]
        samples = np.einsum("gk,tkx->tgx", grid, mesh.vertices[around])
        least = np.linalg.norm(samples - point, axis=2).min()
        assert np.linalg.norm(nearest - point) < least + 1e-6


def test_lines_run_from_origin_to_insertion_on_the_skin(mesh, lines, template):
    placed = [one.muscle for one in place_muscles(mesh, mesh, AnatomyPerturbation())]
    positions = lines.positions(mesh.vertices, np.zeros(3))
    assert len(set(lines.muscle)) == 36
    for i, muscle in enumerate(placed):
        own = positions[lines.muscle == i]
        ends = own.mean(axis=0)[[0, -1]]
        if muscle.type == _core.MuscleType.sphincter:
            assert np.abs(ends[:, 0]).max() < 0.002  # a half ring ends at the midline
            continue
        assert np.linalg.norm(ends[1] - muscle.insertion.mean(axis=0)) < 0.004
        assert np.linalg.norm(ends[0] - muscle.origin) < 0.012  # over the bone, not in it
    beside = find_on_skin(mesh, positions.reshape(-1, 3)).positions(mesh.vertices)
    gap = np.linalg.norm(beside - positions.reshape(-1, 3), axis=1)
    assert gap.min() > LIFT / 5  # less than LIFT in a fold
    assert np.median(gap) == pytest.approx(LIFT, abs=1e-9)


def test_left_and_right_lines_mirror_each_other(mesh, lines):
    nodes = lines.node_positions(mesh.vertices)
    for i in range(0, 36, 2):
        left, right = nodes[lines.node_muscle == i], nodes[lines.node_muscle == i + 1]
        np.testing.assert_allclose(left, right * [-1, 1, 1], atol=2e-4)


def test_insertions_go_with_the_skin_and_origins_stay_on_the_bone(mesh, lines, anatomy):
    name = "zygomaticus_major.L"
    mode = anatomy.muscle_modes[anatomy.muscle_names.index(name)]
    before = lines.positions(mesh.vertices, np.zeros(3))
    after = lines.positions(refine(mesh, mesh.neutral + mode), np.zeros(3))
    own = lines.muscle == lines.names.index(name)
    moved = np.linalg.norm(after - before, axis=2)[own]
    assert moved[:, 0].max() < 1e-12
    assert 0.005 < moved[:, -1].min() < 0.020
    nodes = lines.node_muscle == lines.names.index(name)
    node_step = lines.node_positions(refine(mesh, mesh.neutral + mode)) - lines.node_positions(
        mesh.vertices
    )
    assert np.linalg.norm(node_step[nodes], axis=1).max() == pytest.approx(
        moved[:, -1].max(), rel=0.05
    )


def test_an_origin_on_the_jaw_goes_with_it(mesh, lines, anatomy):
    mode = anatomy.articulator_modes[anatomy.articulator_names.index("jaw_open")]
    before = lines.positions(mesh.vertices, np.zeros(3))
    after = lines.positions(refine(mesh, mesh.neutral + mode), np.array([1.0, 0, 0]))
    moved = np.linalg.norm(after - before, axis=2)
    on_jaw = moved[lines.muscle == lines.names.index("mentalis.L"), 0]
    on_skull = moved[lines.muscle == lines.names.index("frontalis_medial.L"), 0]
    assert on_jaw.min() > 0.015
    assert on_skull.max() < 1e-4


def test_a_pose_is_the_sum_of_its_shapes(face, rest, mesh, anatomy):
    shapes = shapes_of_anatomy(anatomy)
    chosen = {shapes[3].name: 0.7, shapes[10].name: -0.2, "jaw_open": 0.5}
    by_name = {shape.name: shape for shape in shapes}
    moves = [(v, rest + to_object(by_name[n].offsets), rest) for n, v in chosen.items()]
    pose = face.pose(moves, chosen)
    expected = mesh.neutral + sum(v * by_name[n].offsets for n, v in chosen.items())
    np.testing.assert_allclose(pose.refined, refine(mesh, expected), atol=SINGLE_PRECISION)
    assert pose.jaw[0] == 0.5
    assert pose.activations[3] == 0.7


def test_groups_add_to_the_activations_of_their_muscles(face):
    values = {"zygomaticus_major.L": 0.2, "Lip Corners": 0.3, "Lip Corners.L": 0.1}
    active = dict(zip(face.muscle_names, face.pose([], values).activations, strict=True))
    assert active["zygomaticus_major.L"] == pytest.approx(0.6)
    assert active["zygomaticus_major.R"] == pytest.approx(0.3)
    assert active["frontalis_medial.L"] == 0


def test_active_muscles_are_wider_and_brighter(face):
    quiet = face.strokes(face.pose([], {}))
    assert len(quiet) == 1
    active = face.strokes(face.pose([], {"zygomaticus_major.L": 1.0}))
    assert [s.width for s in active] == sorted(s.width for s in active)
    assert active[-1].width > 3 * active[0].width
    assert active[-1].colours[:, 3].min() > active[0].colours[:, 3].max()
    assert sum(len(s.points) for s in active) == len(quiet[0].points)
    assert all(s.points.dtype == s.colours.dtype == np.float32 for s in active)


def test_nodes_lie_at_the_insertions(face, lines, mesh):
    patch = face.nodes(face.pose([], {}))
    centres = to_head(patch.points.reshape(len(lines.node_muscle), -1, 3).mean(axis=1))
    expected = lines.node_positions(mesh.vertices)
    np.testing.assert_allclose(centres, expected, atol=SINGLE_PRECISION)
    assert patch.triangles.max() == len(patch.points) - 1


def test_strain_of_a_grown_head_is_the_closed_form(face, rest):
    grown = face.pose([(1.0, 1.1 * rest, rest)], {})
    expected = {"area": 0.21, "stretch": 0.1, "compression": 0.1}
    for measure, value in expected.items():
        lowest, highest = face.strain_range(face.strain(grown, measure))
        assert (lowest, highest) == pytest.approx((value, value), abs=1e-9)


def test_strain_of_a_stretched_and_turned_head_is_the_closed_form(face, rest, mesh):
    """Longer along z alone: skin that lies along z is stretched by it, across it by nothing."""
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    pose = face.pose([(1.0, (rest * [1, 1, 1.2]) @ turn.T, rest)], {})
    stretch, area = face.strain(pose, "stretch"), face.strain(pose, "area")
    on_skin = np.unique(mesh.triangles[mesh.triangle_part == "skin"])
    up = mesh.normals[on_skin, 1]  # z of the object is y of the head
    expected = np.sqrt(1 + 0.44 * (1 - up**2)) - 1
    assert np.median(np.abs(stretch[on_skin] - expected)) < 0.003
    assert stretch[on_skin].max() < 0.2 + 1e-9
    np.testing.assert_allclose(area[on_skin], stretch[on_skin], atol=0.02)  # as nothing is across


def test_a_turned_head_has_no_strain(face, rest):
    turn = np.array([[0.0, -1, 0], [0.6, 0, -0.8], [0.8, 0, 0.6]])
    pose = face.pose([(1.0, rest @ turn.T, rest)], {})
    for measure in ("area", "stretch", "compression"):
        assert np.abs(face.strain(pose, measure)).max() < 1e-9


def test_a_raised_brow_stretches_the_lid_and_compresses_the_forehead(face, rest, anatomy, mesh):
    brows = [i for i, name in enumerate(anatomy.muscle_names) if name.startswith("frontalis")]
    raised = rest + to_object(anatomy.muscle_modes[brows].sum(axis=0))
    area = face.strain(face.pose([(1.0, raised, rest)], {}), "area")
    forehead = multiply(mesh.stencils, 1.0 * mesh.in_region("forehead")) > 0.9
    assert area[forehead].min() < -0.05
    assert area.max() > 0.05


def test_colours_end_at_the_limit():
    colours = strain_colours(np.array([-1.0, -0.2, 0, 0.2, 1.0]), 0.2)
    np.testing.assert_array_equal(colours[0], colours[1])
    np.testing.assert_array_equal(colours[3], colours[4])
    assert colours[1, 2] > colours[1, 0]  # blue shrinks
    assert colours[3, 0] > colours[3, 2]  # red grows
    assert colours[2, 3] == pytest.approx(FAINTEST)
    assert colours[1, 3] == colours[3, 3] == pytest.approx(STRONGEST)
    with pytest.raises(InvalidInput, match="limit"):
        strain_colours(np.zeros(3), 0.0)


def test_the_scale_shows_what_the_skin_shows():
    points, colours = scale_strip(10, 20, 100, 8, num_steps=4)
    assert points.min(axis=0).tolist() == [10, 20]
    assert points.max(axis=0).tolist() == [110, 28]
    np.testing.assert_array_equal(colours[0, :3], strain_colours(np.array(-1.0), 1)[:3])
    np.testing.assert_array_equal(colours[-1, :3], strain_colours(np.array(1.0), 1)[:3])


def test_another_mesh_is_refused(rest):
    with pytest.raises(InvalidInput, match="vertices"):
        LiveFace(rest[:-1])
    with pytest.raises(InvalidInput):
        LiveFace(np.where(np.arange(len(rest))[:, None] == 3, np.nan, rest))


def test_an_unknown_measure_is_refused(face):
    with pytest.raises(InvalidInput, match="shear"):
        face.strain(face.pose([], {}), "shear")
