# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput, _core
from mimetic.muscles import anatomy
from mimetic.muscles.motion import NUM_MODES, dynamics_options, load_skin, substeps
from mimetic.skin.mesh import multiply
from mimetic.template.face_template import load_template

from evaluation.anatomy import motion_table, rotation_table


@pytest.fixture(scope="module")
def loaded():
    template = load_template()
    return load_skin(template.vertices, template)


@pytest.fixture(scope="module")
def reduced(loaded):
    return loaded.reduced(dynamics_options())


def test_loads_give_the_modes_of_the_anatomy(loaded):
    template = loaded.mesh.template
    attached = anatomy.attach(template.vertices, template)
    free = np.flatnonzero(loaded.skin.free)
    responses = loaded.skin.model.solve(loaded.forces.reshape(len(loaded.forces), -1).T)
    for i in (0, 22, 35):
        mode = attached.muscle_modes[i][free].ravel()
        np.testing.assert_allclose(responses[:, i], mode, atol=1e-9)
    jaw = attached.articulator_modes[0][free].ravel()
    np.testing.assert_allclose(responses[:, loaded.names.index("jaw_open")], jaw, atol=1e-9)


def test_reduced_skin_moves_within_a_percent_of_the_whole_one(loaded):
    values = motion_table.clip_values("startle", loaded.names, 0.3)
    static, reduced = motion_table.compare(loaded, values, [NUM_MODES])
    assert reduced.share < 0.01
    assert reduced.largest_mm < 0.1
    assert static.share > 0.1  # else damping and relaxation would not be seen at all


def test_reduced_skin_comes_to_rest_at_the_static_response(loaded):
    skin = loaded.reduced(dynamics_options(0.5, _core.TimeScheme.backward_euler), 0)
    values = np.linspace(0, 1, len(loaded.names))
    for _ in range(200):
        coordinates = skin.advance(values)
    static = loaded.skin.model.solve((values @ loaded.forces.reshape(len(values), -1))[:, None])
    np.testing.assert_allclose(skin.shapes @ coordinates, static[:, 0], atol=1e-7)


def test_surface_of_the_reduced_skin_is_its_stencils(loaded, reduced):
    reduced.reset()
    coordinates = reduced.advance(np.full(len(loaded.names), 0.5))
    stencils = loaded.visible_stencils()
    surface = _core.ReducedSurface(stencils, reduced.shapes)
    expected = multiply(stencils, (reduced.shapes @ coordinates).reshape(-1, 3))
    assert np.linalg.norm(expected, axis=1).max() > 1e-4
    np.testing.assert_allclose(surface.displacements(coordinates), expected, atol=1e-8)


def test_lowest_frequency_is_that_of_skin_on_its_attachment(loaded):
    """Soft skin slides on its fat: sqrt(k_t / m) bounds the lowest mode from both sides."""
    materials = loaded.skin.materials
    table = anatomy.load_table("materials.toml")["motion"]
    mass = table["density"] * materials.thickness + table["fat_density"] * table["fat_depth"] / 3
    local = np.sqrt(materials.tangential / mass) / (2 * np.pi)
    lowest = _core.vibration_modes(loaded.skin.model, loaded.mass, 2).frequencies[0]
    assert local.min() < lowest < 2 * np.median(local)


def test_a_smile_turns_the_cheek_further_than_the_linear_skin_knows(loaded):
    corotational = loaded.corotational()
    small = rotation_table.linear_error(loaded, corotational, "zygomaticus_major.L", 0.1)
    large = rotation_table.linear_error(loaded, corotational, "zygomaticus_major.L", 0.5)
    assert max(small.residual, large.residual) <= 1e-4
    assert small.r2 > 0.9995
    assert 0.99 < large.r2 < small.r2
    assert large.largest_mm > 4 * small.largest_mm  # grows faster than the motion


def test_values_between_frames_lie_on_straight_lines():
    values = np.array([[0.0, 2.0], [1.0, 0.0], [1.0, 1.0]])
    between = substeps(values, 4)
    assert between.shape == (9, 2)
    np.testing.assert_allclose(between[[0, 2, 4, 8]], [[0, 2], [0.5, 1], [1, 0], [1, 1]])
    with pytest.raises(InvalidInput, match="two frames"):
        substeps(values[:1])
    with pytest.raises(InvalidInput, match="finite"):
        substeps(values * np.nan)


def test_options_out_of_range_are_named():
    with pytest.raises(InvalidInput, match="step is"):
        dynamics_options(-1.0)
    with pytest.raises(InvalidInput, match="relaxation_time"):
        _core.DynamicsOptions(relaxation_time=0.0)
