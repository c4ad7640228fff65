# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of a live face that can be frozen, or recorded apart."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.muscles.anatomy import muscle_groups, muscle_names
from mimetic.muscles.articulators import JAW
from mimetic.muscles.extras import LIP_SHAPES
from mimetic.puppet.parts import BROW_GROUPS, EYE_GROUPS

HEAD_POSITION, HEAD_ROTATION = "head_position", "head_rotation"
EYES, MOUTH, BROWS = "eyes", "mouth", "brows"
CHANNELS = (HEAD_POSITION, HEAD_ROTATION, EYES, MOUTH, BROWS)


def channel_of(name: str) -> str:
    """The channel of a muscle, an articulator or an angle of the gaze."""
    if name.startswith(("gaze_", "lid_")):
        return EYES
    if name in JAW or name in LIP_SHAPES:
        return MOUTH
    group = dict(zip(muscle_names(), muscle_groups().tolist(), strict=True)).get(name)
    if group in BROW_GROUPS:
        return BROWS
    return EYES if group in EYE_GROUPS else MOUTH


def check_channels(channels: Collection[str]) -> None:
    """Raises InvalidInput."""
    for channel in channels:
        if channel not in CHANNELS:
            raise InvalidInput(f"there is no channel {channel!r}; there are {', '.join(CHANNELS)}")


@dataclass
class Freezer:
    """Holds the channels that are frozen as they were when that began.

    names: of the values. `frozen` may change at any time.
    """

    names: Sequence[str]
    frozen: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        check_channels(self.frozen)
        self._channels = np.array([channel_of(name) for name in self.names])
        self._pose: NDArray[np.float64] | None = None
        self._values: NDArray[np.float64] | None = None

    def apply(
        self, pose: NDArray[np.float64], values: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The pose (4 x 4) and values with frozen channels as they were."""
        pose, values = pose.copy(), values.copy()
        if self._pose is not None and self._values is not None:
            if HEAD_ROTATION in self.frozen:
                pose[:3, :3] = self._pose[:3, :3]
            if HEAD_POSITION in self.frozen:
                pose[:3, 3] = self._pose[:3, 3]
            is_frozen = np.isin(self._channels, list(self.frozen))
            values[is_frozen] = self._values[is_frozen]
        self._pose, self._values = pose, values
        return pose.copy(), values.copy()
