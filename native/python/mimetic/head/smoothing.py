# SPDX-License-Identifier: GPL-3.0-or-later
"""Head motion without jitter and without lag: the Kalman smoother over poses.

Rauch, Tung and Striebel 1965. State: rotation vector from the clip's mean pose and translation, and
their rates, which take random accelerations. A pose counts by its own covariance, so that frames
which were hard to measure lean on their neighbours; held frames do not count at all. How lively the
head is, is told by the clip itself: the accelerations under which its poses are most likely.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from mimetic import InvalidInput
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.shared.rotations import (
    Floats,
    from_rotation_vectors,
    inverse_left_jacobians,
    mean_rotation,
    rotation_vectors,
)

# Densities of angular (rad^2/s^3) and linear (m^2/s^3) acceleration: a still head to a shaken one
TURNS = 10.0 ** np.arange(-5, 3.1, 1.0)
SHIFTS = 10.0 ** np.arange(-7, 1.1, 1.0)
JUDGED_FRAMES = 600  # enough to tell how lively a head is
USUAL_STRENGTH = (
    0.5  # covariances also hold what neighbouring frames share, such as the model's error
)
UNKNOWN_RATE = 3.0  # rad/s and m/s, standard deviation before the first frame
LEAST_STD = 1e-6  # rad and m: a covariance of 0 is a measurement like any other


def check_strength(strength: float) -> None:
    """Raises InvalidInput below 0."""
    if not np.isfinite(strength) or strength < 0:
        raise InvalidInput(f"smoothing is {strength}; it must be 0 or more")


def smoothed(performance: Performance, strength: float = USUAL_STRENGTH) -> Performance:
    """The performance with its head motion smoothed; all else is shared.

    strength: what the poses' standard deviations are multiplied by; 1 takes them as they are,
    more smooths more, 0 leaves the motion alone. Raises InvalidInput below 0.
    """
    poses, covariances = smooth_poses(
        performance.head_pose,
        performance.head_pose_cov,
        performance.frame / performance.fps,
        performance.quality >= HELD_QUALITY,
        strength,
    )
    return replace(performance, head_pose=poses, head_pose_cov=covariances)


def smoothed_scenes(
    performance: Performance, starts: Collection[int], strength: float
) -> Performance:
    """As `smoothed`, each scene of a clip for itself, with the covariances of single frames.

    starts: the frames with which another scene starts.
    """
    bounds = np.searchsorted(performance.frame, sorted(starts))
    poses = performance.head_pose.copy()
    for part in np.split(np.arange(len(poses)), bounds):
        if len(part):
            poses[part], _ = smooth_poses(
                poses[part],
                performance.head_pose_cov[part],
                performance.frame[part] / performance.fps,
                performance.quality[part] >= HELD_QUALITY,
                strength,
            )
    return replace(performance, head_pose=poses)


def smooth_poses(
    poses: Floats,
    covariances: Floats,
    seconds: Floats,
    counts: Floats,
    strength: float = USUAL_STRENGTH,
) -> tuple[Floats, Floats]:
    """Smooths rigid motions, forward and backward, so that nothing comes late.

    poses: N x 4 x 4; covariances: N x 6 x 6 of (rotation vector, translation), a turn d standing
    for exp(d) R; seconds: N, rising; counts: N, false where a pose was not measured.
    returns: N x 4 x 4 and N x 6 x 6. Raises InvalidInput where rounding leaves nothing to solve.
    """
    check_strength(strength)
    counts = np.asarray(counts, dtype=bool)
    if strength == 0 or counts.sum() < 3:
        return poses.copy(), covariances.copy()
    reference = mean_rotation(poses[counts, :3, :3])
    vectors = rotation_vectors(poses[:, :3, :3] @ reference.T)
    measured = np.concatenate([vectors, poses[:, :3, 3]], axis=1)
    to_local = np.tile(np.eye(6), (len(poses), 1, 1))
    to_local[:, :3, :3] = inverse_left_jacobians(vectors)
    noise = to_local @ (covariances + LEAST_STD**2 * np.eye(6)) @ to_local.transpose(0, 2, 1)
    steps = np.diff(seconds)
    noise = strength**2 * noise
    try:
        with np.errstate(over="raise", invalid="raise"):
            liveliness = _liveliness(measured, noise, steps, counts)
            states, spreads = _smooth(measured, noise, steps, counts, liveliness)
    except (np.linalg.LinAlgError, FloatingPointError):
        raise InvalidInput(
            "the head's motion cannot be smoothed: its covariances or its times are beyond what a "
            "capture gives; smooth by 0, or capture the footage again"
        ) from None
    result = poses.copy()
    result[:, :3, :3] = from_rotation_vectors(states[:, :3]) @ reference
    result[:, :3, 3] = states[:, 3:6]
    back = np.tile(np.eye(6), (len(poses), 1, 1))
    back[:, :3, :3] = np.linalg.inv(inverse_left_jacobians(states[:, :3]))
    spreads = back @ spreads[:, :6, :6] @ back.transpose(0, 2, 1)
    return result, 0.5 * (spreads + spreads.transpose(0, 2, 1))


def _liveliness(measured: Floats, noise: Floats, steps: Floats, counts) -> Floats:
    """The densities (2: of turns and shifts) under which the poses are most likely."""
    part = slice(0, JUDGED_FRAMES)
    given = measured[part], noise[part], steps[: JUDGED_FRAMES - 1], counts[part]
    liveliness = np.array([0.1, 1e-3])
    for axis, densities in ((0, TURNS), (1, SHIFTS), (0, TURNS)):
        tried = np.tile(liveliness, (len(densities), 1))
        tried[:, axis] = densities
        liveliness[axis] = densities[np.argmax(_likelihoods(*given, tried))]
    return liveliness


def _likelihoods(measured, noise, steps, counts, liveliness: Floats) -> Floats:
    """Logarithms of the likelihood under G choices (G x 2), by the filters' surprises."""
    total = np.zeros(len(liveliness))
    for surprise, spread in _surprises(measured, noise, steps, counts, liveliness):
        weighted = np.linalg.solve(spread, surprise[..., None])[..., 0]
        total -= np.einsum("gi,gi->g", surprise, weighted) + np.linalg.slogdet(spread)[1]
    return total


def _surprises(measured, noise, steps, counts, liveliness: Floats):
    """Runs G filters side by side; yields what they did not expect, G x 6, and its spread."""
    num_filters, first = len(liveliness), int(np.argmax(counts))
    state = np.tile(np.concatenate([measured[first], np.zeros(6)]), (num_filters, 1))
    spread = np.tile(_first_spread(noise[first]), (num_filters, 1, 1))
    for i in range(first + 1, len(measured)):
        step = steps[i - 1]
        state, spread = _predicted(state, spread, step, _acceleration(step, liveliness))
        if counts[i]:
            surprise = measured[i] - state[:, :6]
            expected = spread[:, :6, :6] + noise[i]
            yield surprise, expected
            state, spread = _corrected(state, spread, surprise, expected)


def _smooth(measured, noise, steps, counts, liveliness: Floats):
    """States N x 12 and their covariances N x 12 x 12, from all frames."""
    first = int(np.argmax(counts))
    state = np.concatenate([measured[first], np.zeros(6)])[None]
    spread = _first_spread(noise[first])[None]
    states, spreads, expected_states, expected_spreads = [state], [spread], [], []
    for i in range(first + 1, len(measured)):
        step = steps[i - 1]
        state, spread = _predicted(state, spread, step, _acceleration(step, liveliness[None]))
        expected_states.append(state)
        expected_spreads.append(spread)
        if counts[i]:
            difference = measured[i] - state[:, :6]
            state, spread = _corrected(state, spread, difference, spread[:, :6, :6] + noise[i])
        states.append(state)
        spreads.append(spread)
    for i in range(len(states) - 2, -1, -1):
        ahead = _ahead(steps[first + i])
        gain = spreads[i] @ ahead.T @ np.linalg.inv(expected_spreads[i])
        change = states[i + 1] - expected_states[i]
        states[i] = states[i] + np.einsum("gij,gj->gi", gain, change)
        narrower = spreads[i + 1] - expected_spreads[i]
        spreads[i] = spreads[i] + gain @ narrower @ gain.transpose(0, 2, 1)
    # Before the first measured frame the head is held, as it was captured
    states = [states[0]] * first + states
    spreads = [spreads[0]] * first + spreads
    return np.concatenate(states), np.concatenate(spreads)


def _first_spread(noise: Floats) -> Floats:
    spread = UNKNOWN_RATE**2 * np.eye(12)
    spread[:6, :6] = noise
    return spread


def _ahead(step: float) -> Floats:
    """12 x 12: the state a step (seconds) later, by its rates."""
    ahead = np.eye(12)
    ahead[:6, 6:] = step * np.eye(6)
    return ahead


def _acceleration(step: float, liveliness: Floats) -> Floats:
    """G x 12 x 12: what random accelerations of the densities (G x 2) add in a step."""
    density = np.repeat(liveliness, 3, axis=1)[:, :, None] * np.eye(6)
    top = np.concatenate([density * step**3 / 3, density * step**2 / 2], axis=2)
    bottom = np.concatenate([density * step**2 / 2, density * step], axis=2)
    return np.concatenate([top, bottom], axis=1)


def _predicted(state: Floats, spread: Floats, step: float, added: Floats):
    ahead = _ahead(step)
    return state @ ahead.T, ahead @ spread @ ahead.T + added


def _corrected(state: Floats, spread: Floats, surprise: Floats, expected: Floats):
    gain = np.linalg.solve(expected, spread[:, :6, :]).transpose(0, 2, 1)
    spread = spread - gain @ expected @ gain.transpose(0, 2, 1)
    spread = 0.5 * (spread + spread.transpose(0, 2, 1))
    return state + np.einsum("gij,gj->gi", gain, surprise), spread
