# SPDX-License-Identifier: GPL-3.0-or-later
"""The network of what is before a face: a drawn person whom training never shows."""

import hashlib

import numpy as np
import pytest
from mimetic import UnreadableMedia, _core
from mimetic.locate.feature_networks import OCCLUSION, occlusion_network
from mimetic.shared.installed_data import data_folder
from PIL import Image

from evaluation.runs.rendered import CHECKOUT
from scripts.build.eyes_and_lips.crops import Shots
from scripts.build.eyes_and_lips.shots import FIRST_SEED, draw
from scripts.build.occlusion import occluders
from scripts.build.occlusion.pictures import CELLS, SIDE, sample, square_of

STRANGER = FIRST_SEED - 1


@pytest.fixture(scope="module")
def stranger(tmp_path_factory):
    """Shots of somebody whom training never shows."""
    path = tmp_path_factory.mktemp("people") / f"{STRANGER}.npz"
    draw(path)
    with np.load(path, allow_pickle=False) as arrays:
        return Shots(**arrays)


def picture_of(shots, shot):
    """A shot (H x W x 3) before plain grey, and where the face is in it (H x W)."""
    cover = shots.frames[shot][..., 3:] / 255
    image = (shots.frames[shot][..., :3] * cover + 110 * (1 - cover)).astype(np.uint8)
    return np.ascontiguousarray(image), cover[..., 0] > 0.9


def crop_of(shots, shot):
    square = square_of(shots, shot)
    return _core.FeatureCrop(square.center, square.side, square.roll)


def test_the_installed_file_is_the_one_that_was_fitted():
    folder = CHECKOUT / "native" / "data"
    digest = (folder / OCCLUSION).with_suffix(".sha256").read_text("ascii").split()[0]
    for path in (folder / OCCLUSION, data_folder() / OCCLUSION):
        assert hashlib.sha256(path.read_bytes()).hexdigest() == digest
    assert (folder / OCCLUSION).stat().st_size < 1.1e6


def test_it_was_fitted_to_squares_that_the_core_lays(stranger):
    matrix, (height, width) = stranger.intrinsics, stranger.frames.shape[1:3]
    camera = _core.Camera(matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2], width, height)
    for shot, pose in enumerate(stranger.head_pose):
        square, laid = square_of(stranger, shot), _core.occlusion_square(camera, pose)
        np.testing.assert_allclose(square.center, laid.center, atol=1e-6)
        np.testing.assert_allclose((square.side, square.roll), (laid.side, laid.roll), atol=1e-6)


def test_a_sample_says_where_it_is_painted(stranger):
    rng = np.random.default_rng(4)
    shares = []
    for shot in range(8):
        picture, covered, face = sample(stranger, shot, rng)
        assert picture.shape == (SIDE, SIDE, 3) and covered.shape == face.shape == (CELLS, CELLS)
        assert face[CELLS // 2, CELLS // 2] > 0.9 and 0 <= covered.min() <= covered.max() <= 1
        shares.append(covered.mean())
    assert min(shares) == 0 < max(shares)


@pytest.mark.parametrize("painter", [occluders.hand, occluders.microphone])
def test_things_before_a_face_are_seen_and_a_bare_one_is_bare(stranger, painter):
    rng, network = np.random.default_rng(8), occlusion_network()
    hidden, bare, nothing = [], [], []
    for shot in range(len(stranger.frames)):
        image, face = picture_of(stranger, shot)
        side, crop = len(image), crop_of(stranger, shot)
        nothing.append(network.see(image, crop).share())
        colours, cover = painter(side, np.median(image[face], axis=0), rng)
        painted = image + cover[..., None] * (np.clip(colours, 0, 255) - image)
        seen = network.see(np.ascontiguousarray(painted.astype(np.uint8)), crop)
        places = np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2)
        is_hidden = seen.at(places.astype(float)).reshape(side, side) > 0.5
        inside = _inside(crop, places).reshape(side, side) & face
        hidden.append(is_hidden[inside & (cover > 0.99)])
        bare.append(is_hidden[inside & (cover == 0)])
    assert np.mean(np.concatenate(hidden)) > 0.6
    assert np.mean(np.concatenate(bare)) < 0.05
    assert np.mean(nothing) < 0.02 and max(nothing) < 0.1


def _inside(crop, places):
    """Which pixels are in the square."""
    c, s = np.cos(crop.roll), np.sin(crop.roll)
    off = (places - crop.center) @ np.array([[c, -s], [s, c]])
    return (np.abs(off) < crop.side / 2).all(1)


def test_a_damaged_file_is_refused(tmp_path):
    damaged = tmp_path / "occlusion.onnx"
    damaged.write_bytes((data_folder() / OCCLUSION).read_bytes()[:5000])
    with pytest.raises(UnreadableMedia, match=r"occlusion\.onnx: missing or damaged"):
        _core.OcclusionNetwork(str(damaged))


def test_a_square_beside_the_picture_is_refused():
    image = np.asarray(Image.new("RGB", (64, 48)))
    with pytest.raises(_core.InvalidInput, match="beside the picture"):
        occlusion_network().see(image, _core.FeatureCrop((500.0, 20.0), 40.0))
