# SPDX-License-Identifier: GPL-3.0-or-later
"""Eigenspaces are trained, kept in a file and find what they were trained on."""

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.eigenspaces import Eigenspaces, train

SIDE = 12


def draw(rng, count):
    """Patches (K,12,12): two dark eyes and a bar of random strength."""
    y, x = np.mgrid[:SIDE, :SIDE]
    patches = []
    for _ in range(count):
        eyes = sum(np.exp(-0.5 * ((x - c) ** 2 + (y - 4) ** 2)) for c in (3, 8.5))
        bar = np.exp(-0.5 * ((y - 9) / 0.8) ** 2) * ((x > 3) & (x < 8))
        grey = 150 - 90 * rng.uniform(0.7, 1) * eyes - 60 * rng.uniform(0.5, 1) * bar
        patches.append(grey + rng.normal(0, 5, grey.shape))
    return np.clip(patches, 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def model():
    patches = draw(np.random.default_rng(1), 120)
    eye = train(patches[:, 1:8, 0:7], 4)
    mouth = train(patches[:, 6:12, 2:10], 4)
    modules = [
        # Middles of the cut-outs, from the middle of the patch, in its widths
        _core.FaceModule("eye.R", eye, 7 / SIDE, ((3 - 5.5) / SIDE, (4 - 5.5) / SIDE)),
        _core.FaceModule("mouth", mouth, 8 / SIDE, ((5.5 - 5.5) / SIDE, (8.5 - 5.5) / SIDE)),
    ]
    spaces = [train(patches[:, ::-1], 6), train(patches, 6)]
    return Eigenspaces(spaces, [-22.0, 0.0], modules, 0.002 * np.eye(4))


@pytest.fixture
def image():
    rng = np.random.default_rng(2)
    grey = rng.integers(110, 190, (100, 130)).astype(np.uint8)
    grey[30:66, 60:96] = np.kron(draw(rng, 1)[0], np.ones((3, 3)))
    return grey


def test_a_face_is_found_with_its_parts_and_view(model, image):
    options = _core.SpaceSearchOptions(smallest=20, num_matches=2)
    first, second = model.find(image, options)
    assert first.score > second.score
    assert first.yaw == 0
    np.testing.assert_allclose(first.match.center, (77.5, 47.5), atol=1.5)
    assert first.match.width == pytest.approx(36, rel=0.15)
    np.testing.assert_allclose(first.places["eye.R"], (70, 43), atol=2)
    np.testing.assert_allclose(first.places["mouth"], (77.5, 56.5), atol=2)


def test_the_map_peaks_where_the_patch_is(model, image):
    grey = image.copy()
    patch = draw(np.random.default_rng(9), 1)[0]
    grey[70:82, 11:23] = patch
    likelihood = _core.likelihood_map(model.views[1], grey)
    assert likelihood.shape == (100 - SIDE + 1, 130 - SIDE + 1)
    assert np.unravel_index(np.argmax(likelihood), likelihood.shape) == (70, 11)
    away = _core.eigenspace_distance(model.views[1], patch.ravel().astype(float))
    assert likelihood[70, 11] == pytest.approx(away.log_likelihood, rel=1e-4)
    assert away.within >= 0
    assert away.from_space >= 0


def test_a_model_comes_back_as_saved(model, image, tmp_path):
    model.save(tmp_path / "m.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["m.npz"]
    loaded = Eigenspaces.load(tmp_path / "m.npz")
    assert loaded.yaws == model.yaws
    assert [module.name for module in loaded.modules] == ["eye.R", "mouth"]
    before, after = model.find(image)[0], loaded.find(image)[0]
    np.testing.assert_allclose(after.places["mouth"], before.places["mouth"], atol=1e-3)
    assert after.score == pytest.approx(before.score, rel=1e-5)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"schema": np.array(99)}, "schema 99"),
        ({"view_1_basis": np.zeros((6, SIDE * SIDE))}, "view_1: .*orthonormal"),
        ({"view_0_mean": np.zeros(7)}, "view_0_basis has the shape"),
        ({"view_0_rho": np.array(-1.0)}, "above 0"),
        ({"covariance": np.eye(3)}, "covariance has the shape"),
        ({"yaws": np.zeros(99)}, "yaws has the shape"),
        ({"module_names": np.array([1.0, 2.0])}, "module_names has the type"),
    ],
)
def test_bad_models_are_refused(model, tmp_path, changes, said):
    model.save(tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz") as arrays:
        np.savez(tmp_path / "m.npz", **(dict(arrays) | changes))
    with pytest.raises(InvalidInput, match=said):
        Eigenspaces.load(tmp_path / "m.npz")


def test_what_is_no_model_is_refused(tmp_path):
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    with pytest.raises(InvalidInput, match="lacks schema"):
        Eigenspaces.load(tmp_path / "other.npz")
    (tmp_path / "text.npz").write_bytes(b"text")
    with pytest.raises(UnreadableMedia, match=r"text\.npz"):
        Eigenspaces.load(tmp_path / "text.npz")


def test_patches_without_contrast_are_refused():
    with pytest.raises(InvalidInput, match="no contrast"):
        train(np.full((20, 8, 8), 90, np.uint8), 3)
    with pytest.raises(InvalidInput, match="K x H x W"):
        train(np.zeros((8, 8), np.uint8), 3)
