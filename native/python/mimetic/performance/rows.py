# SPDX-License-Identifier: GPL-3.0-or-later
"""The performance as it grows, one row a frame."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from itertools import compress
from typing import Self

import numpy as np
from numpy.typing import NDArray

from mimetic import _core


@dataclass(frozen=True)
class State:
    frame: int
    estimate: _core.FrameEstimate
    held: bool  # nothing was measured: the estimate is the last good frame's


@dataclass
class Rows:
    """The performance as it grows, one row a frame."""

    frame: list[int] = field(default_factory=list)
    pose: list[NDArray[np.float64]] = field(default_factory=list)
    pose_cov: list[NDArray[np.float64]] = field(default_factory=list)
    values: list[NDArray[np.float64]] = field(default_factory=list)
    values_std: list[NDArray[np.float64]] = field(default_factory=list)
    detail: list[NDArray[np.float64]] = field(default_factory=list)
    detail_std: list[NDArray[np.float64]] = field(default_factory=list)
    quality: list[float] = field(default_factory=list)
    irises: list[NDArray[np.float64]] = field(default_factory=list)  # 2 x 6, as the estimate's
    evidence: list[NDArray[np.float32]] = field(default_factory=list)

    def append(self, state: State) -> None:
        # Copies: a view would keep all the estimate, a tenth of a megabyte a frame.
        estimate = state.estimate
        self.frame.append(state.frame)
        self.pose.append(np.array(estimate.camera_from_head))
        self.pose_cov.append(np.array(estimate.pose_cov))
        self.values.append(np.array(estimate.values))
        self.values_std.append(np.array(estimate.values_std))
        self.detail.append(np.array(estimate.detail))
        self.detail_std.append(np.array(estimate.detail_std))
        self.quality.append(0.0 if state.held else estimate.quality)
        self.irises.append(np.array(estimate.irises) * (not state.held))
        self.evidence.append(_core.pack_evidence(estimate) * np.float32(not state.held))

    def reversed(self) -> Self:
        return type(self)(*(getattr(self, column.name)[::-1] for column in fields(self)))

    def __add__(self, after: Self) -> Self:
        names = [column.name for column in fields(self)]
        return type(self)(*(getattr(self, name) + getattr(after, name) for name in names))

    def within(self, first: int, last: int) -> Self:
        """Only the frames from first to last, both included."""
        is_within = [first <= frame <= last for frame in self.frame]
        columns = (getattr(self, column.name) for column in fields(self))
        return type(self)(*(list(compress(column, is_within)) for column in columns))

    def rigid_poses(self) -> NDArray[np.float64]:
        """N x 4 x 4, rotations orthonormal to the last digit."""
        poses = np.array(self.pose)
        poses[:, :3, :3] = _core.nearest_rotations(poses[:, :3, :3])
        poses[:, 3] = [0, 0, 0, 1]
        return poses

    def pose_covariances(self) -> NDArray[np.float64]:
        """N x 6 x 6 without the rounding that makes them asymmetric or indefinite."""
        return _core.nearest_covariances(np.array(self.pose_cov))
