# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones that turn a character's eyes, by how its eyeballs were seen to turn when they moved.

Gaze is not fitted to the skin as other controls are: an eyeball's surface says nothing of where it
looks.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.performance.gaze import SIDES
from mimetic.retarget.bone_channels import BoneChannel

TURNS = 1e-3  # radians at value 1: what turns an eye by less does not turn it
AHEAD = np.array([0.0, -1.0, 0.0])  # in the character frame

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class GazeChannel:
    """One channel of a bone.

    turns: 2 x 3, rotation vectors of the left and the right eye at value 1, near rest, in the
    mesh's frame; is_aim: the eye looks at the bone, which moves: values are as the tangent.
    """

    name: str
    bone: str
    is_aim: bool
    lowest: float
    highest: float
    turns: Floats


@dataclass(frozen=True)
class GazeControls:
    """Those of a character that turn an eye.

    object_from_character: 4 x 4, how its head lies in the mesh's frame; sides: of the eyes that the
    mesh has, among L and R.
    """

    channels: Sequence[GazeChannel]
    object_from_character: Floats
    sides: Sequence[str] = SIDES

    @property
    def ranges(self) -> Floats:
        """K x 2: least and greatest values."""
        return np.array([(c.lowest, c.highest) for c in self.channels]).reshape(-1, 2)

    @property
    def names(self) -> list[str]:
        return [channel.name for channel in self.channels]

    def turned(self, rotation: Floats) -> GazeControls:
        """As seen in a frame that is turned (3 x 3, from this one)."""
        own = [replace(c, turns=c.turns @ np.asarray(rotation).T) for c in self.channels]
        return replace(self, channels=own)

    def without(self, names: Iterable[str]) -> GazeControls:
        left_out = set(names)
        return replace(self, channels=[c for c in self.channels if c.name not in left_out])

    def values(self, angles: Floats) -> Floats:
        """N x K values of the channels for a gaze (N x 4 degrees, as `gaze.GAZE`), in their order;
        0 for a channel that another one stands in for."""
        turns = np.concatenate([self.turn_of(angles, eye) for eye in range(2)], axis=1)
        return self._solver().values(turns)

    def turn_of(self, angles: Floats, eye: int) -> Floats:
        """N x 3: rotation vectors that such a gaze asks of an eye (0 or 1)."""
        return _core.gaze_turns(angles[:, 2 * eye], angles[:, 2 * eye + 1]) @ self._axes().T

    def undriven(self) -> list[str]:
        """Sides of eyes that no channel turns."""
        return [SIDES[eye] for eye in self._solver().undriven()]

    def _axes(self) -> Floats:
        matrix = np.asarray(self.object_from_character, dtype=np.float64)
        return _core.rotation_of(matrix[:3, :3], "head")

    def _solver(self) -> _core.EyeChannels:
        bones = list(dict.fromkeys(channel.bone for channel in self.channels))
        return _core.EyeChannels(
            [bones.index(channel.bone) for channel in self.channels],
            [channel.is_aim for channel in self.channels],
            [channel.turns for channel in self.channels],
            self._axes() @ AHEAD,
            [SIDES.index(side) for side in self.sides],
        )


def turns_eyes(channel: GazeChannel) -> bool:
    return float(np.abs(channel.turns).max()) > TURNS


def turn_between(before: ArrayLike, after: ArrayLike) -> Floats:
    """3: the rotation vector by which points (P x 3) have turned, as a whole."""
    rotation = _core.fit_similarity(np.asarray(before), np.asarray(after)).rotation
    return _core.rotation_vectors(rotation[None])[0]


def gaze_channel(channel: BoneChannel, turned: Floats, step: float) -> GazeChannel:
    """What is known of a channel by which eyes turned so (2 x 3) from value -step to +step."""
    is_aim, (low, high) = not channel.is_turn, channel.range
    rates = _core.eye_rates(turned, is_aim, step)
    return GazeChannel(channel.name, channel.bone, is_aim, low, high, rates)
