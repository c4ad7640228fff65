# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of `mimetic evaluate puppet`."""

import numpy as np
import pytest
from mimetic import _core
from sample_performance import make_performance

from evaluation.runs import puppet
from evaluation.runs.puppet import Blinks, HeldOut, _blinks, as_json, as_text, score_held_out
from evaluation.runs.puppet_tolerance import (
    CONDITIONS,
    UNTOLD_ZOOM,
    Tolerance,
    _moved,
    disturbed,
    seen_by,
)

CAMERA = _core.Camera(400.0, 400.0, 159.5, 119.5, 320, 240)


def spot(x, y):
    image = np.zeros((240, 320, 3), np.uint8)
    image[y - 2 : y + 3, x - 2 : x + 3] = 200
    return image


def middle(image):
    y, x = np.nonzero(image[:, :, 0] > 60)
    return np.array([x.mean(), y.mean()])


@pytest.mark.parametrize(
    ("kind", "amount"), [("scale", 25), ("scale", -25), (UNTOLD_ZOOM, 25), ("rotation", 20)]
)
def test_a_picture_moves_as_the_pose_that_is_said_of_it(kind, amount):
    pose = np.eye(4)
    pose[:3, 3] = [0.05, 0.03, 0.5]
    x, y = CAMERA.fx * 0.1 + CAMERA.cx, CAMERA.fy * 0.06 + CAMERA.cy
    moved = _moved(pose, kind, amount)[:3, 3]
    camera = seen_by(CAMERA, kind, amount)
    expected = camera.fx * moved[:2] / moved[2] + [camera.cx, camera.cy]
    picture = disturbed(spot(round(x), round(y)), kind, amount, CAMERA, np.random.default_rng(1))
    np.testing.assert_allclose(middle(picture), expected, atol=1.0)
    assert picture.shape == (camera.height, camera.width, 3)


def test_every_condition_changes_the_picture_and_a_scale_its_size():
    image = np.random.default_rng(2).integers(60, 180, (240, 320, 3)).astype(np.uint8)
    for kind, amount, _ in CONDITIONS:
        changed = disturbed(image, kind, amount, CAMERA, np.random.default_rng(1))
        assert (changed.shape == image.shape) == (kind not in ("scale", UNTOLD_ZOOM))
        assert changed.dtype == np.uint8
        assert np.array_equal(changed, image) == (kind == "none")
    larger = disturbed(image, "scale", 15, CAMERA, np.random.default_rng(1))
    assert larger.shape == (276, 368, 3)  # so that nothing leaves the picture
    brighter = disturbed(image, "offset", 30, CAMERA, np.random.default_rng(1))
    np.testing.assert_array_equal(brighter, image + 30)


def test_a_blink_is_counted_once_from_shut_to_open():
    closure = np.array([0, 0.2, 0.6, 0.9, 0.45, 0.55, 0.2, 0, 0, 0.45, 0.2, 0.8, 0.1])
    assert _blinks(closure) == [(2, 6), (11, 12)]


def test_a_clip_without_time_to_hold_out_is_left_out_and_said(tmp_path, monkeypatch):
    performance = make_performance(72)
    assert performance.num_frames / performance.fps < 2 * puppet.BLOCK
    performance.save(tmp_path / "single_face.npz")
    monkeypatch.setattr(puppet, "teach", lambda *_, **__: pytest.fail("taught"))
    lines = []
    assert list(score_held_out(lines.append, tmp_path)) == []
    assert lines == ["single_face: left out, shorter than 4 s taught and 4 s tried"]


def test_the_tables_have_what_was_scored():
    scores = [
        HeldOut("clip", "parts", "linear", "group 1", 0.1, 0.95, 0.02, 0.9),
        Blinks("clip", "parts", "linear", 3, 1.0, 0.0),
        Tolerance("clip", "free", "scale", 15, True, 0.05, 0.012),
    ]
    text = as_text(scores)
    assert "clip, parts, linear, group 1" in text and "0.95" in text
    assert "clip, head: free, scale 15" in text and "growth within the paper's limits" in text
    assert '"HeldOut"' in as_json(scores)
    assert as_text(scores[1:2]).startswith("blinks")
