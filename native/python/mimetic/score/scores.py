# SPDX-License-Identifier: GPL-3.0-or-later
"""What is measured, on plain arrays: N frames, K points, M muscles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
# Points count as moving where truth takes them farther than this from where rigid motion would.
MOVING_PX, MOVING_M = _core.MOVING_PX, _core.MOVING_M
SILENT = 0.01  # activation up to which truth does not move a muscle
ACTIVE = 0.1  # a control whose true value reaches this
INTERVAL_90 = 1.6449  # standard deviations
LARGEST_LAG = 8  # frames


def project(points: Floats, head_pose: Floats, intrinsics: Floats) -> Floats:
    """Pixels (..., K, 2) of points (..., K, 3) in the head frame, poses (..., 4, 4)."""
    rotation, shift = head_pose[..., :3, :3], head_pose[..., None, :3, 3]
    pixels = (points @ np.swapaxes(rotation, -1, -2) + shift) @ intrinsics.T
    return pixels[..., :2] / pixels[..., 2:]


def image_motion(
    tracks: Floats, rigid: Floats, is_visible: Bools, predictions: Floats
) -> dict[str, float]:
    """Scores of predicted tracks (N,K,2) against true ones, from where they are in frame 0.

    rigid (N,K,2): where the true head's motion alone would take the points of frame 0.
    """
    scores = _core.score_image_motion(tracks, rigid, is_visible, predictions)
    return {
        "r2": scores.explained,
        "nonrigid_r2": scores.explained_beyond_head,
        "median_px": scores.median_px,
        "p95_px": scores.percentile_95_px,
        "moving_median_px": scores.moving_median_px,
        "nonrigid_rms_px": scores.beyond_head_rms_px,
    }


def surface_motion(points: Floats, is_visible: Bools, predictions: Floats) -> dict[str, float]:
    """Scores of predicted points (N,K,3), each in its own head frame, against true ones.

    Head frames of two models differ by how each was fitted, so the predicted motion is turned by
    the rotation that best aligns its points of frame 0 with the true ones; only motion counts.
    """
    scores = _core.score_surface_motion(points, is_visible, predictions)
    return {
        "r2": scores.explained,
        "median_mm": scores.median_mm,
        "moving_median_mm": scores.moving_median_mm,
        "neutral_shape_median_mm": scores.shape_median_mm,
    }


def head_motion(true_pose: Floats, pose: Floats) -> dict[str, float]:
    """Errors of the motion since frame 0, so that the choice of head frame does not count.

    Rotations are compared in camera axes: pitch about x, yaw about y, roll about z (components of
    the rotation vector of the error). Translation is that of the midpoint between the ears.
    """
    error = head_errors(true_pose, pose)
    shifts = [1000 * (p[:, :3, 3] - p[0, :3, 3]) for p in (pose, true_pose)]
    shift = np.abs(shifts[0] - shifts[1])[1:]
    mean = np.abs(error[1:]).mean(0)
    return {
        "pitch_deg": float(mean[0]),
        "yaw_deg": float(mean[1]),
        "roll_deg": float(mean[2]),
        "largest_deg": float(np.sqrt((error**2).sum(axis=1).max())),
        "sideways_mm": float(shift[:, :2].mean()),
        "depth_mm": float(shift[:, 2].mean()),
    }


def head_errors(true_pose: Floats, pose: Floats) -> Floats:
    """Rotation vectors (N,3), degrees, camera axes, of the error in turning since frame 0."""
    return _core.head_turn_errors(true_pose, pose)


def correlation(true: Floats, estimates: Floats) -> float:
    """Pearson's, over time; nan where the truth does not vary, 0 where the estimate does not."""
    a, b = true - true.mean(), estimates - estimates.mean()
    if np.abs(a).max() < 1e-9:
        return float("nan")
    if np.abs(b).max() < 1e-9:
        return 0.0
    return float(a @ b / np.sqrt((a @ a) * (b @ b)))


def lag_frames(true: Floats, estimates: Floats) -> float:
    """How many frames the estimate comes after the truth: peak of the correlation of rates."""
    a, b = np.gradient(true), np.gradient(estimates)
    lags = np.arange(-LARGEST_LAG, LARGEST_LAG + 1)
    if len(a) <= 2 * LARGEST_LAG or np.abs(a).max() < 1e-9 or np.abs(b).max() < 1e-9:
        return float("nan")
    match = np.array([_overlap(a, b, lag) for lag in lags])
    best = int(match.argmax())
    if best in (0, len(lags) - 1):
        return float(lags[best])
    before, at, after = match[best - 1 : best + 2]
    curvature = before - 2 * at + after
    return float(lags[best] + (0.5 * (before - after) / curvature if curvature < 0 else 0))


def activations(true: Floats, estimates: Floats, std: Floats) -> dict[str, float]:
    """Overall figures of activations (N,M) and whether their standard deviations hold.

    Values that truth leaves silent are easily held, being bounded at 0, and most values of a face
    are: so the intervals' share is that of the values that truth moves, the silent ones beside it.
    """
    error = estimates - true
    active = true.max(0) > ACTIVE
    silent = true.max(0) < SILENT
    is_inside = np.abs(error) <= INTERVAL_90 * std
    is_moving = true > SILENT
    each = [correlation(true[:, m], estimates[:, m]) for m in np.flatnonzero(active)]
    return {
        "median_correlation": _median(np.array(each)),
        "rmse": float(np.sqrt((error**2).mean())),
        "rmse_active": float(np.sqrt((error[:, active] ** 2).mean())) if active.any() else np.nan,
        "largest_false": float(estimates[:, silent].max()) if silent.any() else float("nan"),
        "median_std": _median(std),
        "coverage_90": _share(is_inside[is_moving]),
        "coverage_90_silent": _share(is_inside[~is_moving]),
    }


def _overlap(a: Floats, b: Floats, lag: int) -> float:
    """Correlation of a(t) with b(t + lag) over a window that is the same for every lag."""
    inner = a[LARGEST_LAG:-LARGEST_LAG]
    later = b[LARGEST_LAG + lag : len(b) - LARGEST_LAG + lag]
    return float(inner @ later / np.sqrt((inner @ inner) * (later @ later) + 1e-30))


def _share(flags: Bools) -> float:
    return float(flags.mean()) if flags.size else float("nan")


def _median(values: Floats) -> float:
    return _percentile(values, 50)


def _percentile(values: Floats, percent: float) -> float:
    values = np.asarray(values, float)
    values = values[np.isfinite(values)]
    return float(np.percentile(values, percent)) if values.size else float("nan")
