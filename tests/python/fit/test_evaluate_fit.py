# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits are scored as said."""

import argparse
import json

import numpy as np
import pytest
from drawn_face import draw
from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.evaluate import add_arguments, run_evaluate
from mimetic.template.face_template import load_template
from test_fit import CAMERA, pose

from evaluation.runs import fit as evaluate_fit
from evaluation.runs.fit_score import Fitted, figures, laid_on, score_shot
from evaluation.runs.portraits import Portraits

FOCAL = np.array([[600.0, 0, 239.5], [0, 600.0, 199.5], [0, 0, 1]])


@pytest.fixture(scope="module")
def template():
    return load_template()


@pytest.fixture(scope="module")
def portraits(template):
    poses = [pose(0, 0, 0), pose(12, 0, 0)]
    return Portraits(
        images=np.stack([draw(template, template.vertices, one, CAMERA) for one in poses]),
        person=np.zeros(2, int),
        head_pose=np.stack(poses),
        intrinsics=np.stack([FOCAL] * 2),
        yaw=np.array([0.0, 12.0]),
        pitch=np.zeros(2),
        neutral_vertices=template.vertices[None].copy(),
    )


def turned(degrees):
    """A small turn about the camera's x axis."""
    a = np.radians(degrees)
    turn = np.eye(4)
    turn[1:3, 1:3] = [[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]
    return turn


def test_the_truth_itself_has_no_errors(portraits, template):
    one = figures(
        [score_shot(Fitted(template.vertices, pose(0, 0, 0), 600), portraits, 0, template)]
    )
    assert max(abs(value) for value in one.values()) < 1e-6


def test_errors_of_known_size(portraits, template):
    bent = turned(5) @ pose(0, 0, 0)
    bent[:3, 3] = pose(0, 0, 0)[:3, 3]
    wider = template.vertices * (1.1, 1, 1)
    one = figures([score_shot(Fitted(wider, bent, 660), portraits, 0, template)])
    assert one["pitch"] == pytest.approx(5, abs=1e-6)
    assert one["yaw"] == pytest.approx(0, abs=1e-6)
    assert one["focal"] == pytest.approx(10)
    assert one["node_median"] > 5
    assert 0.5 < one["mesh_median"] < 4


def test_laying_on_undoes_turn_shift_and_scale():
    points = np.random.default_rng(1).normal(size=(40, 3))
    moved = 1.3 * points @ turned(30)[:3, :3].T + (1, 2, 3)
    np.testing.assert_allclose(laid_on(moved, points), points, atol=1e-9)


def test_scores_and_average_of_drawn_portraits(tmp_path, portraits, template):
    scores = evaluate_fit.score_fits(portraits, template)
    assert (scores.num_pictures, scores.num_found) == (2, 2)
    assert {*evaluate_fit.VARIANTS, evaluate_fit.TOGETHER} <= scores.rows.keys()
    assert scores.rows["as shipped"]["node_median"] < 8
    evaluate_fit.write(scores, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["fit.json", "fit_average.png"]
    assert json.loads((tmp_path / "fit.json").read_text())["found"] == 2
    assert "2 of 2 portraits fitted" in evaluate_fit.as_text(scores)


def test_files_that_are_no_portraits_are_refused(tmp_path, portraits, template):
    with pytest.raises(UnreadableMedia):
        Portraits.load(tmp_path / "missing.npz", template)
    arrays = {name: getattr(portraits, name) for name in vars(portraits)}
    np.savez(tmp_path / "a.npz", **arrays)
    assert len(Portraits.load(tmp_path / "a.npz", template).images) == 2
    for change, text in (
        ({"person": np.array([0, 7])}, "person must be"),
        ({"neutral_vertices": np.zeros((1, 5, 3))}, "5 vertices"),
        ({"images": arrays["images"].astype(np.uint16)}, "uint8"),
    ):
        np.savez(tmp_path / "b.npz", **(arrays | change))
        with pytest.raises(InvalidInput, match=text):
            Portraits.load(tmp_path / "b.npz", template)


def test_options_that_do_not_go_with_fit_are_refused(tmp_path):
    parser = argparse.ArgumentParser()
    add_arguments(parser)
    with pytest.raises(InvalidInput, match="do not go with `fit`"):
        run_evaluate(parser.parse_args(["fit", "--truth", str(tmp_path)]))
    with pytest.raises(InvalidInput, match="go with `mimetic evaluate locate`"):
        run_evaluate(parser.parse_args(["fit", "--images", str(tmp_path)]))
