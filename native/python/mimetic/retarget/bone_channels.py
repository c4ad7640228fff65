# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of a face as controls: which of a rig's bones are of its face, and what their values key.

A control is one channel of a bone: its location along one of its axes, or a jaw's turn about its
own x. Value 1 is a centimetre of the world, or ten degrees.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.rig_motion import rotation_channels

FACE = re.compile(r"jaw|chin|lid|brow|lip|mouth|cheek|nose", re.IGNORECASE)
TURNING = re.compile(r"jaw", re.IGNORECASE)
# Bones that a rig's own mechanism moves: of Rigify, Auto-Rig Pro
MECHANISM = re.compile(r"^(DEF|ORG|MCH|VIS)[-_]|_(ref|stretch)\.", re.IGNORECASE)
CENTIMETRE = 0.01  # metres at value 1
TURN = np.radians(10.0)  # at value 1
RANGE = (-3.0, 3.0)  # of values: 3 cm, 30 degrees


@dataclass(frozen=True)
class BoneChannel:
    """axis: 0 to 2, of the bone; is_turn: about it, else along it."""

    bone: str
    axis: int
    is_turn: bool

    @property
    def name(self) -> str:
        return f"{self.bone} {'turn' if self.is_turn else 'along'} {'xyz'[self.axis]}"


def face_bones(names: Sequence[str]) -> list[str]:
    """Those of a rig's bones that an animator moves its face by, by their names."""
    return [name for name in names if FACE.search(name) and not MECHANISM.search(name)]


def channels_of(
    name: str, can_move: bool, locks: Sequence[bool], turn_locked: bool
) -> list[BoneChannel]:
    """A face bone's channels. locks: of its location along x, y, z; turn_locked: about x."""
    channels = [BoneChannel(name, axis, False) for axis in range(3) if can_move and not locks[axis]]
    if TURNING.search(name) and not turn_locked:
        channels.append(BoneChannel(name, 0, True))
    return channels


def nearest_surface() -> _core.ControlFitOptions:
    """Options of a fit to bones: a centimetre means no more than where it takes the skin."""
    options = _core.ControlFitOptions()
    options.unmatched_motion = 1.0
    return options


def at_rest(
    responses: NDArray[np.float64], points: NDArray[np.float64], rest: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What controls do (K x V x 3) to a mesh that something holds turned (its points: V x 3), as
    they would do it to the mesh at rest (V x 3)."""
    return _core.fit_similarity(points, rest).turn(responses)


def turns(values: NDArray[np.float64], rotation_mode: str) -> tuple[str, NDArray[np.float64]]:
    """The property that a rotation mode reads, and its curves (N x 3 or 4), for turns about x."""
    vectors = np.zeros((len(values), 3))
    vectors[:, 0] = TURN * values
    return rotation_channels(_core.from_rotation_vectors(vectors), rotation_mode)
