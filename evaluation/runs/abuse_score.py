# SPDX-License-Identifier: GPL-3.0-or-later
"""Held or right: a followed face under abuse against the same clip without it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from mimetic.performance.document import HELD_QUALITY
from numpy.typing import NDArray

from evaluation.runs.head_score import degrees_between

FAR_DEGREES = 10.0
FAR_METRES = 0.05  # across the line of sight
SOON = 0.5  # seconds in which a face that is back is to be followed again


@dataclass(frozen=True)
class AbuseTruth:
    """What is known of an abused clip, frame by frame."""

    head_pose: NDArray[np.float64]  # N x 4 x 4, camera from head, of the clip without abuse
    clean: NDArray[np.bool_]  # N: the picture is untouched
    gone: NDArray[np.bool_]  # N: it does not show the face
    shift: NDArray[np.float64]  # N x 2: where the picture slid to, pixels
    fps: float
    later: bool  # the face is followed backward, from a frame after the abuse


def score_abuse(
    truth: AbuseTruth,
    head_pose: NDArray[np.float64],
    quality: NDArray[np.float64],
    intrinsics: NDArray[np.float64],
) -> dict[str, float]:
    """Figures of one clip; head_pose: N x 4 x 4, quality: N.

    touched: frames that are not clean. wrong: frames above the held quality without the face, or
    far off. worst: degrees, of frames above it that show the face. lost: clean frames that are held
    though the face was not just away. back: seconds until it is followed again.
    """
    is_followed = quality >= HELD_QUALITY
    degrees, metres = apart(head_pose, slid(truth.head_pose, truth.shift, intrinsics))
    far = (degrees > FAR_DEGREES) | (metres > FAR_METRES)
    right = is_followed & ~far
    back, returning = _back(truth, right)
    in_view = is_followed & ~truth.gone
    return {
        "touched": float(np.sum(~truth.clean)),
        "wrong": float(np.sum(is_followed & (truth.gone | far))),
        "worst": float(degrees[in_view].max()) if in_view.any() else math.nan,
        "lost": float(np.sum(truth.clean & ~is_followed & ~returning)),
        "back": back,
    }


def _back(truth: AbuseTruth, right: NDArray[np.bool_]) -> tuple[float, NDArray[np.bool_]]:
    """Seconds from the first clean frame after the abuse to the first right one; frames between."""
    order = np.arange(len(right))[:: -1 if truth.later else 1]
    touched_frames = np.flatnonzero(~truth.clean[order])
    returning = np.zeros(len(right), bool)
    if not len(touched_frames):
        return 0.0, returning
    after = order[touched_frames[-1] + 1 :]
    right_frames = np.flatnonzero(right[after])
    num_away = int(right_frames[0]) if len(right_frames) else len(after)
    returning[after[:num_away]] = True
    return (num_away / truth.fps if len(right_frames) else math.inf), returning


def slid(
    head_pose: NDArray[np.float64], shift: NDArray[np.float64], intrinsics: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Poses of a head (N x 4 x 4) whose picture slid: turned about the camera with its sight."""
    shifted_pose = head_pose.copy()
    for pose, step in zip(shifted_pose, shift, strict=True):
        if not step.any():
            continue
        sight = intrinsics @ pose[:3, 3]
        pixel = np.array([*(sight[:2] / sight[2] + step), 1])
        turn = _turn_between(pose[:3, 3], np.linalg.solve(intrinsics, pixel))
        pose[:3] = turn @ pose[:3]
    return shifted_pose


def _turn_between(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """The shortest rotation (3 x 3) that takes direction a to direction b."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    axis = np.cross(a, b)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + cross + cross @ cross / (1 + a @ b)


def apart(
    a: NDArray[np.float64], b: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Degrees between poses (N x 4 x 4), and metres across the line of sight."""
    degrees = degrees_between(a[:, :3, :3], b[:, :3, :3])
    depth = b[:, 2, 3]
    away = a[:, :2, 3] / a[:, 2:3, 3] - b[:, :2, 3] / b[:, 2:3, 3]
    return degrees, np.linalg.norm(away, axis=1) * depth
