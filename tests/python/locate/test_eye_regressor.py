# SPDX-License-Identifier: GPL-3.0-or-later
"""The regressor of lids that is fitted to drawn people, beside the iris network alone."""

import hashlib

import numpy as np
import pytest
from mimetic import UnreadableMedia, _core
from mimetic.locate.feature_networks import EYE_POINTS, FILES, eye_regressor
from mimetic.shared.installed_data import data_folder

from evaluation.runs.real_methods import networks_alone
from evaluation.runs.rendered import CHECKOUT
from scripts.build.eyes_and_lips.crops import SIDE, Shots, sample, square_of
from scripts.build.eyes_and_lips.shots import FIRST_SEED, draw

MIDDLE_UPPER, MIDDLE_LOWER = 12, 4  # of the contour
MIDDLE = 4  # of a margin's nine stations


@pytest.fixture(scope="module")
def alone(networks):
    return networks_alone()


@pytest.fixture(scope="module")
def stranger(tmp_path_factory):
    """Shots of somebody whom training never shows."""
    path = tmp_path_factory.mktemp("people") / f"{FIRST_SEED - 1}.npz"
    draw(path)
    with np.load(path, allow_pickle=False) as arrays:
        return Shots(**arrays)


def test_the_installed_file_is_the_one_that_was_fitted():
    folder = CHECKOUT / "native" / "data"
    digest = (folder / EYE_POINTS).with_suffix(".sha256").read_text("ascii").split()[0]
    for path in (folder / EYE_POINTS, data_folder() / EYE_POINTS):
        assert hashlib.sha256(path.read_bytes()).hexdigest() == digest
    assert (folder / EYE_POINTS).stat().st_size < 1.5e6


def test_it_was_fitted_to_squares_that_the_core_lays(stranger):
    matrix, (height, width) = stranger.intrinsics, stranger.frames.shape[1:3]
    camera = _core.Camera(matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], width, height)
    for shot, pose in enumerate(stranger.head_pose):
        crops = _core.feature_crops(camera, pose, stranger.anchors[:6])
        for eye, crop in enumerate(crops.eyes):
            square = square_of(stranger, shot, eye)
            np.testing.assert_allclose(square.center, crop.center, atol=1e-6)
            np.testing.assert_allclose(
                (square.side, square.roll), (crop.side, crop.roll), atol=1e-6
            )


def test_a_sample_shows_its_points(stranger):
    """An open eye's iris is darker than the white beside it, where the points say they are."""
    rng = np.random.default_rng(5)
    openings = np.linalg.norm(
        stranger.lids[:, :, 0, MIDDLE] - stranger.lids[:, :, 1, MIDDLE], axis=2
    )
    darker = []
    for shot, eye in np.argwhere(openings > 12):
        for _ in range(8):
            picture, points = sample(stranger, int(shot), int(eye), rng)
            assert picture.shape == (SIDE, SIDE, 3) and points.shape == (23, 2)
            column, row = np.clip(points * SIDE, 0, SIDE - 1).astype(int).T
            grey = picture.mean(axis=2)
            inside = grey[row[18], column[18]]
            corners = points[[0, 8]]
            assert corners[0, 0] < corners[1, 0]  # mirrored or not, the outer corner is to the left
            darker.append(inside < grey[row[[2, 6, 11, 15]], column[[2, 6, 11, 15]]].mean())
    assert len(darker) > 30 and np.mean(darker) > 0.7


def opening_errors(networks, shots: Shots) -> np.ndarray:
    """Shots x eyes: by how much the lids' middles are seen too far apart, in widths of the eye."""
    errors = np.empty((len(shots.frames), 2))
    for shot, frame in enumerate(shots.frames):
        cover = frame[..., 3:] / 255
        image = np.ascontiguousarray((frame[..., :3] * cover + 110 * (1 - cover)).astype(np.uint8))
        for eye in (0, 1):
            square = square_of(shots, shot, eye)
            crop = _core.FeatureCrop(square.center, square.side, square.roll)
            contour = networks.eye(image, crop, eye == 0).contour
            upper, lower = shots.lids[shot, eye]
            width = np.linalg.norm(upper[-1] - upper[0])
            seen = np.linalg.norm(contour[MIDDLE_UPPER] - contour[MIDDLE_LOWER])
            errors[shot, eye] = (seen - np.linalg.norm(upper[MIDDLE] - lower[MIDDLE])) / width
    return errors


def test_openings_of_a_drawn_stranger_are_nearer_than_by_the_network_alone(
    networks, alone, stranger
):
    with_both, by_network = (np.abs(opening_errors(n, stranger)) for n in (networks, alone))
    assert with_both.mean() < 0.75 * by_network.mean()


def test_without_networks_it_sees_openings_as_well_by_itself(alone, stranger):
    by_regressor, by_network = (
        np.abs(opening_errors(n, stranger)) for n in (eye_regressor(), alone)
    )
    assert by_regressor.mean() < 0.75 * by_network.mean()


def test_it_says_where_it_may_be_off(stranger):
    """What shows no eye is doubted more than an eye; usual eyes are as their networks' error."""
    square = square_of(stranger, 0, 1)
    crop = _core.FeatureCrop(square.center, square.side, square.roll)
    image = np.ascontiguousarray(stranger.frames[0][..., :3])
    noise = np.random.default_rng(4).integers(0, 256, image.shape, dtype=np.uint8)
    eye, nothing = (eye_regressor().eye(picture, crop, False) for picture in (image, noise))
    assert eye.contour.shape == (16, 2) and eye.iris.shape == (5, 2)
    assert 1 < eye.lid_doubt < nothing.lid_doubt
    assert 1 < eye.iris_doubt < nothing.iris_doubt


def test_irises_and_corners_are_the_networks(networks, alone, stranger):
    image = np.ascontiguousarray(stranger.frames[0][..., :3])
    square = square_of(stranger, 0, 1)
    crop = _core.FeatureCrop(square.center, square.side, square.roll)
    both, network = networks.eye(image, crop, False), alone.eye(image, crop, False)
    np.testing.assert_array_equal(both.iris, network.iris)
    np.testing.assert_array_equal(both.contour[[0, 8]], network.contour[[0, 8]])
    assert (both.contour[MIDDLE_UPPER] != network.contour[MIDDLE_UPPER]).all()


def test_a_damaged_file_is_refused_by_its_name(tmp_path):
    files = [str(data_folder() / name) for name in FILES]
    damaged = tmp_path / EYE_POINTS
    damaged.write_bytes(b"\x08\x03" * 500)
    for file in (damaged, tmp_path / "nowhere.onnx"):
        with pytest.raises(UnreadableMedia, match=f"{file.name}.*install Mimetic again"):
            _core.FeatureNetworks(*files, str(file))
