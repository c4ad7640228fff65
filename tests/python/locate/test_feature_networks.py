# SPDX-License-Identifier: GPL-3.0-or-later
"""Networks for eyes and mouth: on a real face beside points marked by hand, and without files."""

import os
import subprocess
import sys

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.fit.fitting import find_face
from mimetic.locate.feature_networks import (
    FILES,
    feature_anchors,
    feature_places,
    installed_networks,
)
from mimetic.media.footage import Footage
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from evaluation.real.drawn_face import SIDE, drawn_face
from evaluation.runs.real_labels import FOLDER, read_labels

FRAME = 13  # of single_face.mp4, marked by hand


@pytest.fixture(scope="module")
def shot(fetched_clip):
    """A frame of a real person, the crops that its fit lays, and the marked points."""
    image = np.ascontiguousarray(Footage(fetched_clip("single_face.mp4")).read(FRAME))
    fit = find_face(image, FRAME)
    anchors = feature_anchors(fit.neutral_vertices(load_template()), load_template())
    crops = _core.feature_crops(fit.camera, np.array(fit.head_pose), anchors)
    labels = read_labels("single_face")
    return image, crops, labels.rows(labels.frame == FRAME)


def test_irises_and_lids_are_where_they_were_marked(networks, shot):
    image, crops, labels = shot
    places = feature_places(networks, image, crops)
    for name in ("iris.L", "iris.R", "lid_upper.L", "lid_lower.R"):
        off = np.linalg.norm(places[name] - labels.of(name)[0, 0])
        assert off < 0.03 * labels.ipd[0], name
    assert networks.mesh(image, crops.face).presence > 0.9


def test_the_lips_are_where_they_were_marked(networks, shot):
    image, crops, labels = shot
    places = feature_places(networks, image, crops)
    for name in ("lip_outer_upper", "lip_inner_upper", "lip_inner_lower", "lip_outer_lower"):
        off = places[name] - labels.of(name)[0, 0]
        assert np.linalg.norm(off) < 0.04 * labels.ipd[0], name


def test_mesh_lips_eyes_and_irises_are_those_that_mediapipe_says(networks):
    """evaluation/real/face_mesh_on_crop.py wrote what it says of the same crop."""
    table = np.loadtxt(FOLDER / "drawn_face.csv", delimiter=",", skiprows=1)
    middle = 0.5 * (SIDE - 1)
    crop = _core.FeatureCrop([middle, middle], SIDE)
    mesh = networks.mesh(drawn_face(), crop, refine_eyes=True)
    left, right = mesh.irises
    said = np.concatenate([mesh.places, right, left]) + 0.5
    np.testing.assert_allclose(said, table, atol=0.01)


def test_without_heads_the_mesh_says_lips_and_eyes_itself(networks):
    folder = data_folder()
    plain = _core.FeatureNetworks(*(str(folder / name) for name in FILES[:2]))
    crop = _core.FeatureCrop([95.5, 95.5], SIDE)
    first, again = (each.mesh(drawn_face(), crop, refine_eyes=True) for each in (plain, networks))
    moved = np.linalg.norm(first.places - again.places, axis=1) > 1e-9
    assert moved.sum() == 80 + 2 * 71
    assert [iris.shape for iris in first.irises] == [(0, 2), (0, 2)]


def test_a_mirrored_picture_shows_the_mirrored_eye(networks, shot):
    image, crops, _ = shot
    left = crops.eyes[0]
    width = image.shape[1]
    mirrored = np.ascontiguousarray(image[:, ::-1])
    crop = _core.FeatureCrop([width - 1 - left.center[0], left.center[1]], left.side, -left.roll)
    eye = networks.eye(image, left, True)
    again = networks.eye(mirrored, crop, False)
    np.testing.assert_allclose(again.iris[:, 0], width - 1 - eye.iris[:, 0], atol=0.1)
    np.testing.assert_allclose(again.contour[:, 1], eye.contour[:, 1], atol=0.1)


def test_points_stay_when_the_crop_moves_a_little(networks, shot):
    image, crops, labels = shot
    crop = crops.eyes[1]
    moved = _core.FeatureCrop(crop.center + np.array([1.5, -1]), crop.side * 1.03, crop.roll + 0.03)
    first = networks.eye(image, crop, False).iris[0]
    second = networks.eye(image, moved, False).iris[0]
    assert np.linalg.norm(first - second) < 0.01 * labels.ipd[0]


def test_where_no_face_is_none_is_seen(networks):
    meadow = np.random.default_rng(3).integers(60, 120, (240, 320, 3), dtype=np.uint8)
    crop = _core.FeatureCrop([160, 120], 180)
    assert networks.mesh(meadow, crop).presence < 0.1
    with pytest.raises(InvalidInput, match="beside the picture"):
        networks.mesh(meadow, _core.FeatureCrop([5000, 120], 180))


def test_their_licence_and_what_was_changed_travel_with_them(networks):
    text = (data_folder() / "networks_license.txt").read_text(encoding="utf-8")
    assert "Apache License" in text and "END OF TERMS AND CONDITIONS" in text
    assert all(name in text for name in FILES)
    assert "turned into ONNX" in text and "cut into parts" in text


def test_without_files_there_are_no_networks(tmp_path, monkeypatch):
    monkeypatch.setenv("MIMETIC_DATA", str(tmp_path))
    assert installed_networks() is None


def test_damaged_files_are_refused_in_one_line(tmp_path, monkeypatch):
    monkeypatch.setenv("MIMETIC_DATA", str(tmp_path))
    for name in FILES:
        (tmp_path / name).write_bytes(b"\x08\x03" * 500)
    with pytest.raises(UnreadableMedia, match="damaged") as error:
        installed_networks()
    assert "\n" not in str(error.value)


FITTED = """
import hashlib, sys
import numpy as np
from mimetic.fit.fitting import find_face
from mimetic.media.footage import Footage
fit = find_face(Footage(sys.argv[1]).read(int(sys.argv[2])))
print(hashlib.sha256(np.array([*fit.identity.values()]).tobytes()).hexdigest())
"""


def test_the_fit_is_the_same_to_the_bit_however_many_threads_work(networks, fetched_clip):
    """On one core too: OpenCV's networks round otherwise where they know of one thread."""
    command = [sys.executable, "-c", FITTED, str(fetched_clip("single_face.mp4")), str(FRAME)]
    prints = {
        subprocess.run(
            command,
            env={**os.environ, "OPENCV_FOR_THREADS_NUM": limit},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for limit in ("1", "2", "3")
    }
    assert len(prints) == 1 and prints.pop().strip()
