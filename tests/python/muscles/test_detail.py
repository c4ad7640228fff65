# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic.muscles.anatomy import attach_skin
from mimetic.muscles.detail import TYPICAL, detail_of
from mimetic.muscles.modes import visible_area
from mimetic.performance.document import Performance
from mimetic.solve.tracking import UNMEASURED
from mimetic.template.face_template import load_template
from sample_performance import make_performance

COUNT = 12


@pytest.fixture(scope="module")
def skin():
    template = load_template()
    return attach_skin(template.vertices, template)


@pytest.fixture(scope="module")
def detail(skin):
    return detail_of(skin.mesh, UNMEASURED, COUNT)


def test_detail_modes_move_the_measured_skin_and_stay_off_the_rest(skin, detail):
    template = skin.mesh.template
    lengths = np.linalg.norm(detail.modes[:, : template.num_skin_vertices], axis=2)
    hidden = template.in_region("ear", "scalp")
    assert detail.modes.shape == (COUNT, *template.vertices.shape)
    assert lengths[:, hidden].max() < 1e-9
    assert lengths[:, template.in_region("cheek")].max(axis=1).min() > 0.3e-3


def test_detail_is_drawn_sideways_where_one_camera_does_not_see_depth(skin, detail):
    frontal = skin.mesh.template.vertices[: skin.mesh.template.num_skin_vertices, 2] > 0.05
    moved = detail.modes[:, : len(frontal)][:, frontal]
    assert (moved[..., 2] ** 2).mean() < 0.3 * (moved[..., :2] ** 2).mean()


def test_detail_moves_skin_that_muscles_hardly_move(skin):
    template = skin.mesh.template
    detail = detail_of(skin.mesh, UNMEASURED)
    seen = (detail.modes[:, : template.num_skin_vertices, :2] ** 2).sum(axis=2)
    deviation = np.sqrt(detail.std**2 @ seen)
    still = ("nose", "nasal_bridge", "temple", "jaw_line", "chin")  # on bone or cartilage
    typical = deviation[template.in_region("cheek")].mean()
    for region in still:
        assert deviation[template.in_region(region)].mean() > 0.7 * typical, region


def test_prior_of_detail_adds_up_and_falls(skin, detail):
    assert np.sum(detail.std**2) == pytest.approx(TYPICAL**2)
    assert (np.diff(detail.std) <= 0).all()
    assert visible_area(skin.mesh).sum() == pytest.approx(0.07, abs=0.03)  # square metres


def with_detail(**changes):
    plain = make_performance()
    rng = np.random.default_rng(3)
    keys = {
        "detail_modes": rng.normal(0, 1e-3, (4, len(plain.neutral_vertices), 3)),
        "detail_coefficients": rng.normal(0, 1, (plain.num_frames, 4)),
        "detail_coefficients_std": np.full((plain.num_frames, 4), 0.2),
    }
    return make_performance(**(keys | changes))


def test_surface_is_that_of_the_muscles_and_detail(tmp_path):
    performance = with_detail()
    performance.save(tmp_path / "performance.npz")
    loaded = Performance.load(tmp_path / "performance.npz")
    expected = performance.without_detail().surface(3) + np.tensordot(
        performance.detail_coefficients[3], performance.detail_modes, axes=1
    )
    np.testing.assert_allclose(loaded.surface(3), expected, atol=1e-8)
    np.testing.assert_array_equal(loaded.detail_coefficients_std, 0.2)
    assert loaded.without_detail().detail_modes is None


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"detail_coefficients": None}, "both or none"),
        ({"detail_coefficients_std": np.full((12, 4), -1.0)}, "must not be negative"),
        ({"detail_modes": None, "detail_coefficients": None}, "without detail_modes"),
        ({"detail_coefficients": np.zeros((12, 5))}, "detail_coefficients"),
    ],
)
def test_detail_that_does_not_fit_is_named(changes, told):
    with pytest.raises(InvalidInput, match=told):
        with_detail(**changes)
