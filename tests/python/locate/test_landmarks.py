# SPDX-License-Identifier: GPL-3.0-or-later
"""The cascade that comes with the package finds landmarks of people it was not trained on."""

import hashlib

import numpy as np
import pytest
from mimetic import InvalidInput, UnreadableMedia
from mimetic.locate.landmarks import (
    FILE_NAME,
    installed_cascade,
    landmark_points,
    load,
    mirrored_order,
)
from mimetic.shared.installed_data import data_folder
from mimetic.template.face_template import load_template

from evaluation.runs.rendered import CHECKOUT
from scripts.build.landmarks.samples import sample
from scripts.build.landmarks.shots import FIRST_SEED, Shots, shots_of


@pytest.fixture(scope="module")
def stranger():
    """Shots of somebody whom training never shows."""
    return Shots.of(shots_of(FIRST_SEED - 1))


def test_installed_cascade_is_the_one_that_was_trained():
    folder = CHECKOUT / "native" / "data"
    output = (folder / "face_landmarks.sha256").read_text("ascii").split()[0]
    for path in (folder / FILE_NAME, data_folder() / FILE_NAME):
        assert hashlib.sha256(path.read_bytes()).hexdigest() == output
    assert (folder / FILE_NAME).stat().st_size < 3e6


def test_landmarks_have_their_mirror_images():
    template = load_template()
    names, weights = landmark_points(template)
    order = mirrored_order(template)
    assert (order[order] == np.arange(len(names))).all()
    assert names[order[names.index("ala.L")]] == "ala.R"
    np.testing.assert_array_equal(weights.sum(axis=1), 1)
    assert installed_cascade().names == names


def test_a_mirrored_sample_shows_the_mirrored_person(stranger):
    order = mirrored_order(load_template())
    names = installed_cascade().names
    one, other = (sample(stranger, 0, order, seed) for seed in (0, 1))
    for shown in (one, other):
        left, right = (shown.places[names.index(f"pupil.{side}")] for side in "LR")
        assert left[0] > right[0]  # the subject's left is the picture's right
        assert shown.image.dtype == np.uint8
    assert one.yaw == -other.yaw


def test_landmarks_of_a_stranger_are_found(stranger):
    cascade = installed_cascade()
    order = mirrored_order(load_template())
    errors = []
    for i in range(len(stranger.grey)):
        shown = sample(stranger, i, order, i % 2)
        start = cascade.start(shown.pupils[1], shown.pupils[0], shown.seen_yaw)
        result = cascade.find(shown.image, start).places
        distance = np.linalg.norm(np.subtract(*shown.pupils)) / np.cos(np.radians(shown.yaw))
        errors.append(np.linalg.norm(result - shown.places, axis=1) / distance)
    assert np.median(errors) < 0.06
    assert np.percentile(errors, 90) < 0.2


def test_what_is_no_cascade_is_refused(tmp_path):
    path = tmp_path / "cascade.npz"
    path.write_bytes(b"no archive")
    with pytest.raises(UnreadableMedia, match="cascade"):
        load(path)
    with np.load(data_folder() / FILE_NAME) as kept:
        arrays = dict(kept)
    for change, text in (({"schema": np.array(9)}, "schema 9"), ({"inputs": None}, "lacks inputs")):
        changed = {name: v for name, v in (arrays | change).items() if v is not None}
        np.savez(path, **changed)
        with pytest.raises(InvalidInput, match=text):
            load(path)
    np.savez(path, **(arrays | {"inputs": arrays["inputs"][:, :, :-1]}))
    with pytest.raises(InvalidInput, match="regression"):
        load(path)
