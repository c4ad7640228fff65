# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoothing takes jitter away and nothing else: no lag, no shrinking, no invention."""

from dataclasses import replace

import numpy as np
import pytest
from mimetic import InvalidInput
from mimetic._core import from_rotation_vectors, rotation_vectors
from mimetic.head.smoothing import smooth_poses, smoothed
from mimetic.performance.document import HELD_QUALITY
from sample_performance import make_performance

FPS = 30.0
ROTATION_STD, TRANSLATION_STD = np.radians([0.25, 0.4, 0.15]), np.array([0.5, 0.5, 4]) * 1e-3


def turning_head(num_frames=240, seed=0):
    """True and measured poses of a head that nods and looks about, with correlated noise."""
    random = np.random.default_rng(seed)
    t = np.arange(num_frames) / FPS
    vectors = np.stack(
        [0.3 * np.sin(2.1 * t), 0.7 * np.sin(1.3 * t + 1), 0.2 * np.sin(0.9 * t)], axis=1
    )
    true = np.tile(np.diag([1.0, -1, -1, 1]), (num_frames, 1, 1))
    true[:, :3, :3] = from_rotation_vectors(vectors) @ true[:, :3, :3]
    true[:, :3, 3] = np.stack([0.03 * np.sin(t), 0.01 * np.cos(2 * t), 0.6 + 0.05 * t / 8], axis=1)
    mixing = np.linalg.cholesky(0.6 * np.eye(6) + 0.4)
    covariance = np.diag(np.r_[ROTATION_STD, TRANSLATION_STD]) @ mixing
    covariance = covariance @ covariance.T
    covariances = np.tile(covariance, (num_frames, 1, 1))
    covariances[num_frames // 2 :] *= 9  # the second half is hard to measure
    errors = np.einsum(
        "nij,nj->ni", np.linalg.cholesky(covariances), random.normal(size=(num_frames, 6))
    )
    return true, disturbed(true, errors), covariances, t


def disturbed(poses, errors):
    result = poses.copy()
    result[:, :3, :3] = from_rotation_vectors(errors[:, :3]) @ poses[:, :3, :3]
    result[:, :3, 3] += errors[:, 3:]
    return result


def pose_errors(poses, true):
    """N x 6: turns (radians) and shifts (metres) from the true poses."""
    turns = [
        rotation_vectors(r[None])[0] for r in poses[:, :3, :3] @ np.swapaxes(true[:, :3, :3], 1, 2)
    ]
    return np.concatenate([turns, poses[:, :3, 3] - true[:, :3, 3]], axis=1)


def rms(errors):
    return np.sqrt((errors**2).mean(axis=0))


@pytest.fixture(scope="module")
def run():
    true, measured, covariances, t = turning_head()
    poses, spreads = smooth_poses(measured, covariances, t, np.ones(len(t), bool), 1.0)
    return true, measured, covariances, t, poses, spreads


def test_errors_shrink_on_every_axis(run):
    true, measured, _, _, poses, _ = run
    before, after = rms(pose_errors(measured, true)), rms(pose_errors(poses, true))
    print("rms before", before, "after", after)
    assert (after < 0.55 * before).all()


def test_nothing_comes_late(run):
    """Noise or not, the smoothed motion fits the true one best without a shift in time."""
    true, _, _, t, poses, _ = run
    yaw = rotation_vectors(poses[:, :3, :3] @ true[0, :3, :3].T)[:, 1]
    expected = rotation_vectors(true[:, :3, :3] @ true[0, :3, :3].T)[:, 1]
    shifts = np.linspace(-2, 2, 41)
    misfits = [
        np.square(yaw[5:-5] - np.interp(t[5:-5] - shift / FPS, t, expected)).sum()
        for shift in shifts
    ]
    assert abs(shifts[np.argmin(misfits)]) <= 0.2


def test_backwards_in_time_gives_the_same_motion(run):
    _, measured, covariances, t, poses, _ = run
    back, _ = smooth_poses(
        measured[::-1], covariances[::-1], t[-1] - t[::-1], np.ones(len(t), bool), 1.0
    )
    # Where the rates are unknown, at the ends, and nowhere else the two directions may differ
    difference = np.abs(pose_errors(back[::-1], poses))
    assert difference[10:-10].max() < 0.02 * ROTATION_STD.min()


def test_its_covariance_is_honest(run):
    true, _, _, _, poses, spreads = run
    errors = pose_errors(poses, true)
    squared = np.einsum("ni,ni->n", errors, np.linalg.solve(spreads, errors[..., None])[..., 0])
    assert 3.5 < squared.mean() < 9  # 6 degrees of freedom
    assert np.linalg.eigvalsh(spreads)[:, 0].min() > 0


def test_frames_that_were_not_measured_are_bridged():
    true, measured, covariances, t = turning_head()
    counts = np.ones(len(t), bool)
    counts[60:72] = False
    measured[60:72] = measured[59]  # held, as a lost head is
    poses, spreads = smooth_poses(measured, covariances, t, counts, 1.0)
    held, bridged = (np.abs(pose_errors(p, true))[60:72, 1].max() for p in (measured, poses))
    assert bridged < 0.25 * held
    assert spreads[65, 1, 1] > 2 * spreads[50, 1, 1]


def test_what_comes_after_a_long_loss_says_nothing_of_the_motion_before():
    true, measured, covariances, t = turning_head(120)
    seen = np.ones(120, bool)
    seen[50:80] = False
    measured[50:80] = measured[49]
    poses, _ = smooth_poses(measured, covariances, t, seen, 1.0)
    before, _ = smooth_poses(measured[:50], covariances[:50], t[:50], seen[:50], 1.0)
    others = measured.copy()
    others[80:] = true[[0]]
    changed, _ = smooth_poses(others, covariances, t, seen, 1.0)
    # How lively the head is, is judged from all of the clip
    assert np.abs(pose_errors(poses[:50], before)).max() < 0.01
    assert np.abs(pose_errors(changed[:50], poses[:50])).max() < 0.01
    # Between them evenly, and no further than either end
    turns = np.linalg.norm(pose_errors(poses[49:81], poses[[49]].repeat(32, axis=0))[:, :3], axis=1)
    assert (np.diff(turns) > -1e-9).all()


def test_a_head_that_is_lost_for_good_stays():
    _, measured, covariances, t = turning_head(80)
    seen = np.arange(80) < 50
    poses, _ = smooth_poses(measured, covariances, t, seen, 1.0)
    assert np.abs(pose_errors(poses[50:], poses[[49]].repeat(30, axis=0))).max() < 1e-12


def test_a_cut_is_not_smoothed_over():
    performance = make_performance(20)
    jittered = performance.head_pose.copy()
    jittered[:, 0, 3] += np.random.default_rng(1).normal(0, 1e-3, 20)
    jittered[10:, 0, 3] += 0.3  # another scene
    performance = replace(
        performance, head_pose=jittered, quality=np.ones(20), scene_starts=np.array([11])
    )
    result = smoothed(performance, 1.0)
    covariances, seconds = performance.head_pose_cov[10:], np.arange(10) / performance.fps
    alone, alone_cov = smooth_poses(jittered[10:], covariances, seconds, np.ones(10), 1.0)
    np.testing.assert_allclose(result.head_pose[10:], alone, atol=1e-12)
    np.testing.assert_allclose(result.head_pose_cov[10:], alone_cov, atol=1e-12)
    assert np.abs(result.head_pose[:10, 0, 3]).max() < 0.01
    assert np.abs(np.diff(result.head_pose[:10, 0, 3])).mean() < 1e-3


def test_a_jitter_free_motion_is_left_as_it_is():
    true, _, covariances, t = turning_head()
    poses, _ = smooth_poses(true, covariances * 1e-4, t, np.ones(len(t), bool), 1.0)
    assert np.abs(pose_errors(poses, true)).max() < 0.1 * ROTATION_STD.min()


def test_more_strength_smooths_more_and_none_changes_nothing():
    _, measured, covariances, t = turning_head(100)
    counts = np.ones(len(t), bool)

    def roughness(strength):
        poses, _ = smooth_poses(measured, covariances, t, counts, strength)
        return np.abs(np.diff(poses[:, :3, :3], 2, axis=0)).mean()

    assert roughness(3.0) < roughness(1.0) < roughness(0.3) < roughness(0.0)
    np.testing.assert_array_equal(smooth_poses(measured, covariances, t, counts, 0.0)[0], measured)
    with pytest.raises(InvalidInput, match="smoothing"):
        smooth_poses(measured, covariances, t, counts, -1.0)


def test_a_performance_keeps_everything_else():
    performance = make_performance()
    result = smoothed(performance)
    result.check()
    assert result.activations is performance.activations
    moved = np.abs(result.head_pose - performance.head_pose)
    assert moved[performance.quality >= HELD_QUALITY].max() < 0.05


def test_covariances_that_leave_nothing_to_solve_are_refused():
    """All of one direction, and of a thousand million square metres: a file may say so."""
    flat = make_performance(head_pose_cov=np.full((12, 6, 6), 1e9))
    with pytest.raises(InvalidInput, match="cannot be smoothed"):
        smoothed(flat)


@pytest.mark.parametrize("num_frames", [1, 2])
def test_too_few_frames_stay_as_they_are(num_frames):
    performance = make_performance(num_frames)
    np.testing.assert_array_equal(smoothed(performance).head_pose, performance.head_pose)
