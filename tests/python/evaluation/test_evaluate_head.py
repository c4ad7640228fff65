# SPDX-License-Identifier: GPL-3.0-or-later
import json

import numpy as np
import pytest
from mimetic.commands.cli import main

from evaluation.runs import head, head_clips
from evaluation.runs.head_score import angles_of, score_head
from evaluation.synthetic.heads.courses import RealCourse, Sweeps
from evaluation.synthetic.heads.hand import covered
from evaluation.synthetic.heads.recipes import SETS

FPS = 30.0


def turned(pitch, yaw, roll):
    course = Sweeps((("yaw", yaw, 1.0), ("pitch", pitch, 1.0), ("roll", roll, 1.0)))
    return course.poses(np.arange(102) / FPS, 0.6, seed=3)


def about(axis, degrees):
    result = np.eye(4)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = [k for k in range(3) if k != axis]
    result[i, i] = result[j, j] = c
    result[i, j], result[j, i] = -s, s
    return result


def test_a_sweep_reaches_its_angles_one_axis_after_the_other():
    angles = angles_of(turned(20, 40, -30)[:, :3, :3])
    assert np.abs(angles[:12]).max() < 1e-9
    np.testing.assert_allclose(angles.max(0), (20, 40, 30), atol=0.5)
    np.testing.assert_allclose(angles.min(0), (-20, -40, -30), atol=0.5)
    assert (np.abs(angles) > 1).sum(1).max() == 1


def test_real_motion_begins_frontal_and_has_no_jumps():
    for file in ("cap12.csv", "franck.csv"):
        angles = angles_of(RealCourse(file).poses(np.arange(290) / FPS, 0.6, 0)[:, :3, :3])
        assert np.abs(angles[:6]).max() < 1
        assert 0.3 < np.abs(np.diff(angles, axis=0)).max() < 6


def test_tuning_and_held_out_share_no_person_and_no_motion():
    tuning, held_out = ({c.film for c in SETS[name]} for name in ("tuning", "held-out"))
    assert not {f.seed for f in tuning} & {f.seed for f in held_out}
    moving = [{f.head_motion for f in films if f.num_frames > 1} for films in (tuning, held_out)]
    assert not moving[0] & moving[1]


def test_axes_and_scale_of_a_method_do_not_count_but_its_errors_do():
    truth = turned(20, 40, 30)
    other = np.einsum("nij,jk->nik", truth, about(0, 12))  # calls other axes the head's
    other[:, :3, 3] = 1.3 * (truth[:, :3, 3] + truth[:, :3, :3] @ (0.01, 0.02, 0.05))
    same = score_head("clip", "sweep", "other", other, truth, FPS, [1e-3]).figures
    assert same["mean"] < 1e-6 and same["translation"] < 1e-6 and same["lost"] == 0
    off = truth.copy()
    off[30:60] = truth[30:60] @ about(1, 4)
    off[60:70] = np.nan
    off[70:80] = truth[70:80] @ about(1, 40)
    scored = score_head("clip", "sweep", "off", off, truth, FPS, [1e-3])
    assert scored.figures["lost"] == 20
    assert np.abs(scored.errors[30:60, 1]).min() > 3.5
    assert np.abs(scored.errors[:30]).max() < 1e-6


def test_drift_and_jitter_are_those_put_in():
    truth = np.repeat(turned(0, 0, 0)[:1], 200, axis=0)
    angles = np.random.default_rng(1).normal(0, 0.2, 200)
    shaken = np.stack([pose @ about(1, a) for pose, a in zip(truth, angles, strict=True)])
    still = score_head("clip", "still", "shaken", shaken, truth, FPS, [1e-3]).figures
    assert still["jitter"] == pytest.approx(0.2 / 3, rel=0.2)
    drifting = np.stack([pose @ about(2, 0.002 * i) for i, pose in enumerate(truth)])
    long = score_head("clip", "long", "drifting", drifting, truth, FPS, [1e-3]).figures
    assert long["drift"] == pytest.approx(2, rel=0.01)


def test_the_hand_covers_a_part_of_the_face_for_a_part_of_the_time():
    frames = np.zeros((30, 120, 160, 4), np.uint8)
    times = np.linspace(0, 5, 30, endpoint=False)
    alpha = covered(frames, times, np.array([80, 60]), 50.0, seed=1)[..., 3] > 128
    face = alpha[:, 35:85, 55:105].mean((1, 2))
    assert 0.2 < face.max() < 0.7
    assert 0.4 < (face == 0).mean() < 0.9


def test_ways_to_follow_are_scored_on_one_rendered_head(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(head, "face_mesh_python", lambda report: None)
    methods = ("ellipsoid", "ellipsoid fast", "ellipsoid flow", "plane flow")
    monkeypatch.setattr(head_clips, "METHODS", {m: head_clips.METHODS[m] for m in methods})
    arguments = ["evaluate", "head", "--set", "small", "--out", str(tmp_path), "--json"]
    assert main(arguments) == 0
    result = json.loads(capsys.readouterr().out)
    scores = result["clips"]["small"]
    assert tuple(scores) == methods
    assert result["summary"]["ellipsoid"]["mean"] < 3
    assert result["summary"]["ellipsoid"]["lost"] == 0
    # Times are of all passes over the clip; the paper's form makes one
    assert scores["ellipsoid"]["passes"] == 2
    assert scores["ellipsoid"]["ms"] > scores["ellipsoid"]["first_pass_ms"] > 0
    assert scores["ellipsoid flow"]["passes"] == 1
    assert scores["ellipsoid flow"]["ms"] == scores["ellipsoid flow"]["first_pass_ms"]
    # As the paper has them: nothing that keeps errors from adding up
    assert scores["ellipsoid"]["mean"] < 0.5 * scores["ellipsoid flow"]["mean"]
    assert scores["ellipsoid flow"]["mean"] < scores["plane flow"]["mean"]
    written = {path.name for path in tmp_path.iterdir()}
    assert written == {"head.json", "head_errors.png", "head_angles.png"}


def test_options_of_other_scores_are_refused(capsys):
    assert main(["evaluate", "head", "--truth", "x.npz"]) == 2
    assert "do not go with `head`" in capsys.readouterr().err
