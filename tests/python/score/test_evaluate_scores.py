# SPDX-License-Identifier: GPL-3.0-or-later
"""Scores of points, head and activations mean what they say."""

from types import SimpleNamespace

import numpy as np
import pytest
from mimetic.score import scores
from mimetic.score.groups import GROUP_NAMES, units_by_group

from evaluation.runs.curves import onset_and_peak, timing_errors


def test_r2_is_that_of_a_known_error(truth):
    rigid = scores.project(truth.points[:1], truth.head_pose, truth.intrinsics)
    halfway = (truth.tracks + rigid) / 2
    result = scores.image_motion(truth.tracks, rigid, truth.visible, halfway)
    assert result["nonrigid_r2"] == pytest.approx(0.75)
    unmoved = np.repeat(truth.tracks[:1], len(truth.frame), axis=0)
    still = scores.image_motion(truth.tracks, rigid, truth.visible, unmoved)
    assert still["r2"] == pytest.approx(0)


def test_a_still_face_has_no_r2(truth):
    still = np.repeat(truth.points[:1], len(truth.frame), axis=0)
    rigid = scores.project(still, truth.head_pose, truth.intrinsics)
    result = scores.image_motion(rigid + 1e-6, rigid, truth.visible, rigid)
    assert np.isnan(result["nonrigid_r2"])
    assert np.isnan(scores.surface_motion(still, truth.visible, still)["r2"])


def test_hidden_points_do_not_count(truth):
    rigid = scores.project(truth.points[:1], truth.head_pose, truth.intrinsics)
    visible = truth.visible.copy()
    visible[:, 0] = False
    wrong = truth.tracks.copy()
    wrong[:, 0] += 50
    assert scores.image_motion(truth.tracks, rigid, visible, wrong)["r2"] == pytest.approx(1)


def test_surface_score_does_not_depend_on_where_the_head_frame_lies(truth):
    angle = 0.2
    turn = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    moved = truth.points @ turn.T + (0.01, 0.02, -0.01)
    result = scores.surface_motion(truth.points, truth.visible, moved)
    assert result["r2"] == pytest.approx(1, abs=1e-9)
    assert result["neutral_shape_median_mm"] < 1e-6


@pytest.mark.parametrize(("axis", "name"), [(0, "pitch_deg"), (1, "yaw_deg"), (2, "roll_deg")])
def test_a_turn_too_far_shows_on_its_axis(axis, name):
    degrees = np.linspace(0, 3, 31)
    pose = np.tile(np.eye(4), (31, 1, 1))
    for i, angle in enumerate(np.radians(degrees)):
        a, b = [k for k in range(3) if k != axis]
        pose[i, a, a] = pose[i, b, b] = np.cos(angle)
        pose[i, a, b], pose[i, b, a] = -np.sin(angle), np.sin(angle)
    result = scores.head_motion(np.tile(np.eye(4), (31, 1, 1)), pose)
    assert result[name] == pytest.approx(np.abs(degrees[1:]).mean())
    assert result["largest_deg"] == pytest.approx(3)
    assert sum(result[key] for key in ("pitch_deg", "yaw_deg", "roll_deg")) == pytest.approx(
        result[name]
    )


def test_lag_is_found_within_a_tenth_of_a_frame():
    time = np.arange(60.0)

    def curve(start):
        return 1 / (1 + np.exp(-(time - start) / 2))

    assert scores.lag_frames(curve(20), curve(22.5)) == pytest.approx(2.5, abs=0.1)


def test_intervals_hold_nine_in_ten_only_if_the_deviations_are_honest():
    rng = np.random.default_rng(0)
    true = np.tile(np.linspace(0, 1, 2000)[:, None], (1, 5))
    estimated = true + rng.normal(0, 0.1, true.shape)
    std = np.full(true.shape, 0.1)
    assert scores.activations(true, estimated, std)["coverage_90"] == pytest.approx(0.9, abs=0.02)
    assert scores.activations(true, estimated, std / 3)["coverage_90"] < 0.5


def test_silent_muscles_do_not_make_intervals_look_honest():
    true = np.zeros((100, 20))
    true[50:, 0] = 0.5  # one of twenty muscles, half of the time
    estimated = np.zeros_like(true)
    result = scores.activations(true, estimated, np.full(true.shape, 0.1))
    assert result["coverage_90"] == 0
    assert result["coverage_90_silent"] == 1
    estimated[:, 0] = 0.5
    result = scores.activations(true, estimated, np.full(true.shape, 0.1))
    assert result["coverage_90"] == 1
    assert result["coverage_90_silent"] == pytest.approx(1 - 50 / 1950)
    still = scores.activations(np.zeros((5, 2)), np.zeros((5, 2)), np.ones((5, 2)))
    assert np.isnan(still["coverage_90"]) and still["coverage_90_silent"] == 1


def test_a_silent_muscle_that_moves_is_a_false_activation():
    true = np.zeros((20, 2))
    true[:, 0] = np.linspace(0, 1, 20)
    estimated = true.copy()
    estimated[7, 1] = 0.3
    result = scores.activations(true, estimated, np.ones(true.shape))
    assert result["largest_false"] == pytest.approx(0.3)
    assert result["rmse_active"] == 0


def test_onset_and_peak_are_read_between_frames():
    time = np.arange(30.0)
    curve = np.interp(time, [5, 10, 14, 20], [0, 1, 1, 0])
    onset, peak = onset_and_peak(curve)
    assert onset == pytest.approx(6, abs=0.05)
    assert peak == pytest.approx((9.5 + 14.6) / 2, abs=0.05)
    late = {"a": (curve, np.interp(time - 2.5, time, curve)), "b": (curve, curve)}
    errors = timing_errors(late, slice(0, 30))
    assert errors["onset"] == pytest.approx([2.5, 0], abs=0.3)
    assert errors["delay"] == pytest.approx([2.5], abs=0.3)


def test_pressed_lips_and_a_tightened_lid_count_for_their_sphincters():
    performance = SimpleNamespace(
        activations=np.tile(np.linspace(0, 0.3, 4)[:, None], len(GROUP_NAMES)),
        groups=np.array(list(GROUP_NAMES)),
        articulators=["jaw_open", "oris_close_upper", "lid_lower.R"],
        articulator_values=np.array([[0.9, 0, 0], [0.9, 0.2, 0.1], [0.9, 0.4, -0.3], [0.9, 0, 0]]),
    )
    sums = units_by_group(performance)
    wanted = {4: [0, 0.3, 0.6, 0.3], 7: [0, 0.2, 0.2, 0.3]}  # a lid that falls tightens nothing
    for group in GROUP_NAMES:
        assert sums[group] == pytest.approx(wanted.get(group, performance.activations[:, 0]))
