# SPDX-License-Identifier: GPL-3.0-or-later
"""The spaces that come with the package are whole, and survive their file."""

import hashlib

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.locate.eigenspaces import FILE_NAME, installed_spaces, load, save, train
from mimetic.shared.installed_data import data_folder

from evaluation.runs.rendered import CHECKOUT
from evaluation.runs.stills import PARTS


@pytest.fixture(scope="module")
def spaces():
    return installed_spaces()


def test_installed_model_is_the_one_that_was_trained():
    folder = CHECKOUT / "native" / "data"
    output = (folder / "face_spaces.sha256").read_text("ascii").split()[0]
    for path in (folder / FILE_NAME, data_folder() / FILE_NAME):
        assert hashlib.sha256(path.read_bytes()).hexdigest() == output
    assert (folder / FILE_NAME).stat().st_size < 1.5e6


def test_installed_model_has_views_and_every_part(spaces):
    yaws = [view.yaw for view in spaces.views]
    assert yaws == sorted(yaws)
    assert min(yaws) < -15 < 15 < max(yaws)
    assert [module.name for module in spaces.modules] == list(PARTS)
    for view in spaces.views:
        left, right, nose, mouth = view.places.reshape(4, 2)
        assert right[0] < nose[0] < left[0]  # the subject's left is the picture's right
        assert max(left[1], right[1]) < nose[1] < mouth[1]
    turned = [view.places.reshape(4, 2)[2, 0] for view in spaces.views]
    assert turned == sorted(turned) or turned == sorted(turned, reverse=True)


def test_spaces_come_back_as_saved(spaces, tmp_path):
    save(spaces, tmp_path / "m.npz")
    assert [path.name for path in tmp_path.iterdir()] == ["m.npz"]
    again = load(tmp_path / "m.npz")
    np.testing.assert_array_equal(again.weights, spaces.weights)
    np.testing.assert_allclose(again.views[0].space.basis, spaces.views[0].space.basis, atol=1e-6)
    assert [module.width for module in again.modules] == [m.width for m in spaces.modules]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"schema": np.array(99)}, "schema 99"),
        ({"view_1_basis": np.zeros((6, 576))}, "view_1_eigenvalues|view_1: "),
        ({"view_0_rho": np.array(-1.0)}, "above 0"),
        ({"covariances": np.zeros((3, 3, 3))}, "covariances has the shape"),
        ({"yaws": np.zeros(99)}, "yaws has the shape"),
        ({"module_names": np.array([1.0] * 4)}, "module_names has the type"),
        ({"weights": np.zeros(3)}, "finite weights are needed"),
        ({"thresholds": np.full(3, np.nan)}, "not finite"),
    ],
)
def test_bad_models_are_refused(spaces, tmp_path, changes, said):
    save(spaces, tmp_path / "m.npz")
    with np.load(tmp_path / "m.npz") as arrays:
        np.savez(tmp_path / "m.npz", **(dict(arrays) | changes))
    with pytest.raises(InvalidInput, match=said):
        load(tmp_path / "m.npz")


def test_what_is_no_model_is_refused(tmp_path):
    np.savez(tmp_path / "other.npz", a=np.zeros(3))
    with pytest.raises(InvalidInput, match="lacks schema"):
        load(tmp_path / "other.npz")
    (tmp_path / "text.npz").write_bytes(b"text")
    with pytest.raises(UnreadableMedia, match=r"text\.npz"):
        load(tmp_path / "text.npz")


def test_windows_without_contrast_are_refused():
    with pytest.raises(InvalidInput, match="no contrast"):
        train(np.full((20, 8, 8), 0.5), 3, 0.01)
    with pytest.raises(InvalidInput, match="K x H x W"):
        train(np.zeros((8, 8)), 3, 0.01)


def test_an_empty_picture_has_no_face(spaces):
    grey = np.random.default_rng(3).integers(90, 160, (240, 320)).astype(np.uint8)
    assert _core.FaceFinder(spaces).find(grey) == []
    locator = _core.FaceLocator(str(data_folder()), spaces=spaces)
    assert locator.locate(np.repeat(grey[..., None], 3, axis=2)) == []
