# SPDX-License-Identifier: GPL-3.0-or-later
"""Head motion without jitter and without lag: the core's smoother over a performance's poses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mimetic import InvalidInput
from mimetic._core import smooth_poses
from mimetic.performance.document import HELD_QUALITY, Performance

# Covariances also hold what neighbouring frames share, such as the model's error
USUAL_STRENGTH = 0.5


def check_strength(strength: float) -> None:
    """Raises InvalidInput below 0."""
    if not np.isfinite(strength) or strength < 0:
        raise InvalidInput(f"smoothing is {strength}; it must be 0 or more")


def smoothed(performance: Performance, strength: float = USUAL_STRENGTH) -> Performance:
    """The performance with its head motion smoothed, each scene for itself; all else is shared.

    strength: what the poses' standard deviations are multiplied by; 1 takes them as they are,
    more smooths more, 0 leaves the motion alone. Raises InvalidInput below 0.
    """
    poses, covariances = performance.head_pose.copy(), performance.head_pose_cov.copy()
    for scene in performance.scenes:
        poses[scene], covariances[scene] = smooth_poses(
            poses[scene],
            covariances[scene],
            performance.frame[scene] / performance.fps,
            (performance.quality[scene] >= HELD_QUALITY).tolist(),
            strength,
        )
    return replace(performance, head_pose=poses, head_pose_cov=covariances)
