# SPDX-License-Identifier: GPL-3.0-or-later
"""How far head poses are from the truth, whatever point and axes a method calls the head's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

AXES = ("pitch", "yaw", "roll")
REST_SECONDS = 0.35  # in which a head looks into the camera: each method's axes are taken from it
LOST_DEGREES = 15.0  # of orientation error, beyond which a head is not followed any more


@dataclass(frozen=True)
class HeadScore:
    """One method on one clip. `errors`: signed, degrees (N,3), nan where it gave no pose."""

    clip: str
    kind: str
    method: str
    figures: dict[str, float]
    angles: NDArray[np.float64] = field(repr=False)  # N x 3, as it sees them, its axes aligned
    true_angles: NDArray[np.float64] = field(repr=False)

    @property
    def errors(self) -> NDArray[np.float64]:
        return self.angles - self.true_angles


def score_head(
    clip: str,
    kind: str,
    method: str,
    poses: NDArray[np.float64],
    truth: NDArray[np.float64],
    fps: float,
    seconds_a_frame: Sequence[float],
) -> HeadScore:
    """poses, truth: camera from head (N,4,4), nan in `poses` where the head was lost.

    seconds_a_frame: of each pass over the clip.
    """
    has_pose = np.isfinite(poses).all((1, 2))
    rest = has_pose & (np.arange(len(poses)) < max(3, round(REST_SECONDS * fps)))
    figures = {"frames": float(len(poses)), "ms": 1e3 * sum(seconds_a_frame)}
    figures |= {"passes": float(len(seconds_a_frame)), "first_pass_ms": 1e3 * seconds_a_frame[0]}
    true_angles = angles_of(truth[:, :3, :3])
    angles = np.full_like(true_angles, np.nan)
    if rest.any():
        aligned_rotations = rotations_like(poses, truth, rest)
        angles[has_pose] = angles_of(aligned_rotations[has_pose])
        figures |= _translation(poses[has_pose], aligned_rotations[has_pose], truth[has_pose])
        has_pose[has_pose] &= (
            degrees_between(aligned_rotations[has_pose], truth[has_pose, :3, :3]) < LOST_DEGREES
        )
    errors = angles - true_angles
    figures |= _of_errors(errors, true_angles[:, AXES.index("yaw")], kind)
    figures["lost"] = float(np.sum(~has_pose))
    return HeadScore(clip, kind, method, figures, angles, true_angles)


def rotations_like(poses: NDArray, truth: NDArray, rest: NDArray) -> NDArray[np.float64]:
    """Rotations (N,3,3) of the poses, about axes that are the truth's in the frames `rest`."""
    return poses[:, :3, :3] @ _mean_turn(truth[rest, :3, :3], poses[rest, :3, :3]).T


def _of_errors(errors: NDArray, yaw: NDArray, kind: str) -> dict[str, float]:
    is_finite = np.isfinite(errors).all(1)
    size = np.abs(errors[is_finite])
    figures = {}
    for axis, one in zip(AXES, size.T, strict=True):
        figures[f"{axis}_mean"] = float(one.mean()) if len(one) else math.nan
        figures[f"{axis}_median"] = float(np.median(one)) if len(one) else math.nan
        figures[f"{axis}_p95"] = float(np.percentile(one, 95)) if len(one) else math.nan
    figures["mean"] = float(size.mean()) if len(size) else math.nan
    figures["median"] = float(np.median(size)) if len(size) else math.nan
    near = size[np.abs(yaw[is_finite]) <= 45]
    figures["mean_to_45"] = float(near.mean()) if len(near) else math.nan
    figures["drift"] = figures["jitter"] = math.nan
    if kind == "long":
        frame = np.flatnonzero(is_finite)
        slopes = np.polyfit(frame, errors[is_finite], 1)[0] * 1000 if len(frame) > 2 else [math.nan]
        figures["drift"] = float(np.linalg.norm(slopes))
    if kind == "still":
        figures["jitter"] = float(errors[is_finite].std(0).mean()) if is_finite.any() else math.nan
    return figures


def _translation(poses: NDArray, rotations: NDArray, truth: NDArray) -> dict[str, float]:
    """Error in % of distance."""
    off = np.linalg.norm(aligned_places(poses, rotations, truth) - truth[:, :3, 3], axis=1)
    return {"translation": float(100 * np.mean(off / np.linalg.norm(truth[:, :3, 3], axis=1)))}


def aligned_places(poses: NDArray, rotations: NDArray, truth: NDArray) -> NDArray[np.float64]:
    """Where the head is (N,3), for the scale and the point of the head that fit the truth best.

    One camera cannot distinguish a large head far away from a small one nearby, and each method
    has a point of its own for a head's origin.
    """
    system = np.concatenate([poses[:, :3, 3:], rotations], axis=2).reshape(-1, 4)
    solution = np.linalg.lstsq(system, truth[:, :3, 3].ravel(), rcond=1e-6)[0]
    return (system @ solution).reshape(-1, 3)


def angles_of(camera_from_head: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pitch, yaw, roll (N,3) in degrees of rotations (N,3,3): 0 is a face turned to the camera."""
    turn = np.diag((1.0, -1.0, -1.0)) @ camera_from_head
    pitch = np.arcsin(np.clip(turn[:, 2, 1], -1, 1))
    yaw = np.arctan2(-turn[:, 2, 0], turn[:, 2, 2])
    roll = np.arctan2(-turn[:, 0, 1], turn[:, 1, 1])
    return np.degrees(np.stack([pitch, yaw, roll], axis=1))


def _mean_turn(truth: NDArray, estimate: NDArray) -> NDArray:
    """The rotation (3,3) of true = found @ rotation.T, mean over frames."""
    u, _, vt = np.linalg.svd(np.einsum("nji,njk->ik", truth, estimate))
    return u @ np.diag((1, 1, np.linalg.det(u @ vt))) @ vt


def degrees_between(a: NDArray, b: NDArray) -> NDArray[np.float64]:
    """N angles between rotations (N x 3 x 3)."""
    cosine = (np.einsum("nij,nij->n", a, b) - 1) / 2
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))
