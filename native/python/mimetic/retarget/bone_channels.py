# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones of a face as controls: which of a rig's bones are of its face, and what their values key.

A control is one channel of a bone: its location along one of its axes, or its turn about one: a
jaw's and a lid's about its own x, an eye's about any. Value 1 is a centimetre of the world, or ten
degrees.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.rig_motion import rotation_channels

# Words of a bone's name, split where its letters change from small to capital, at digits and signs
WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
WHERE = "upper|lower|up|low|top|bottom|bot|inner|outer|out|mid|middle|left|right|center|centre"
# Words that are of a face however they go on, and short ones that begin other words (slide, clip)
FACE = re.compile(
    rf"(?:eye|{WHERE})*(?:(?:jaw|mouth|cheek|nose)\w*|brow(?!n|se)\w*|"
    rf"(?:lid|lip|chin)s?(?:{WHERE}|corner|bone|ctrl|end|tip|root|roll)*)$",
    re.IGNORECASE,
)
TURNING = re.compile(r"jaw", re.IGNORECASE)
LIDS = re.compile(rf"(?:eye|{WHERE})*lids?(?:{WHERE})*$", re.IGNORECASE)
EYES = re.compile(r"eye(?:s|balls?)?$", re.IGNORECASE)
# What an eye's own bone, or the bone that it looks at, is called besides
BESIDE_EYES = re.compile(
    r"(?:[lrcxjm]|left|right|face|facial|head|adj|base|cc|mixamorig|bip|def|target|aim|look|at|ik|fk"
    r"|ctrl|control|con|bone|jnt|joint|track|rot)$",
    re.IGNORECASE,
)
# Bones that a rig's own mechanism moves: of Rigify, Auto-Rig Pro
MECHANISM = re.compile(r"^(DEF|ORG|MCH|VIS)[-_]|_(ref|stretch)\.", re.IGNORECASE)
CENTIMETRE = 0.01  # metres at value 1
TURN = np.radians(10.0)  # at value 1
PROPORTIONAL = 0.15  # of a channel's motion, that may be otherwise than in proportion to its value
RANGE = (-3.0, 3.0)  # of values: 3 cm, 30 degrees
EYE_TURNS, EYE_AIMS = (-6.0, 6.0), (-100.0, 100.0)  # 60 degrees, 1 m: eyes look at what is far


@dataclass(frozen=True)
class BoneChannel:
    """axis: 0 to 2, of the bone; is_turn: about it, else along it; is_of_eye: it may turn an eye,
    and is none of the controls that are fitted to the skin."""

    bone: str
    axis: int
    is_turn: bool
    is_of_eye: bool = False

    @property
    def name(self) -> str:
        return f"{self.bone} {'turn' if self.is_turn else 'along'} {'xyz'[self.axis]}"

    @property
    def range(self) -> tuple[float, float]:
        """Least and greatest value."""
        if not self.is_of_eye:
            return RANGE
        return EYE_TURNS if self.is_turn else EYE_AIMS


def face_bones(names: Sequence[str]) -> list[str]:
    """Those of a rig's bones that an animator moves the skin of its face by, by their names."""
    return [
        name
        for name in names
        if any(FACE.match(word) for word in WORDS.findall(name)) and not MECHANISM.search(name)
    ]


def eye_bones(names: Sequence[str]) -> list[str]:
    """Those that may be an eye, or what one looks at."""
    return [name for name in names if _is_of_eye(name) and not MECHANISM.search(name)]


def _is_of_eye(name: str) -> bool:
    words = WORDS.findall(name)
    return any(EYES.match(word) for word in words) and all(
        EYES.match(word) or BESIDE_EYES.match(word) for word in words
    )


def channels_of(
    name: str, can_move: bool, locks: Sequence[bool], turn_locked: bool
) -> list[BoneChannel]:
    """A face bone's channels. locks: of its location along x, y, z; turn_locked: about x."""
    channels = [BoneChannel(name, axis, False) for axis in range(3) if can_move and not locks[axis]]
    is_lid = any(LIDS.match(word) for word in WORDS.findall(name))
    is_hinge = is_lid and not channels  # a lid that cannot move opens by a turn
    if (TURNING.search(name) or is_hinge) and not turn_locked:
        channels.append(BoneChannel(name, 0, True))
    return channels


def eye_channels_of(
    name: str, can_move: bool, locks: Sequence[bool], turn_locks: Sequence[bool]
) -> list[BoneChannel]:
    """An eye bone's channels. locks, turn_locks: of its location and its turns along x, y, z."""
    along = [axis for axis in range(3) if can_move and not locks[axis]]
    about = [axis for axis in range(3) if not turn_locks[axis]]
    return [
        *(BoneChannel(name, axis, False, True) for axis in along),
        *(BoneChannel(name, axis, True, True) for axis in about),
    ]


def nearest_surface() -> _core.ControlFitOptions:
    """Options of a fit to bones: a centimetre means no more than where it takes the skin, and lips
    that they part by more than muscles do are no expression that muscles cannot make."""
    options = _core.ControlFitOptions()
    options.unmatched_motion, options.hold_slack = 1.0, 0.0
    return options


def reach(
    moved: NDArray[np.float64], response: NDArray[np.float64], end: float, least: float
) -> float:
    """How far a channel may go, of the same sign as its end, for the mesh (V x 3) to move as its
    response says, but for PROPORTIONAL of it: what is off grows as the value's square.

    moved: by the channel at its end; least: as far it may always.
    """
    wanted = end * response
    size = float(np.square(wanted).sum())
    off = float(np.sqrt(np.square(moved - wanted).sum() / size)) if size > 0 else 0.0
    if off <= PROPORTIONAL:
        return end
    return float(np.sign(end)) * max(least, abs(end) * PROPORTIONAL / off)


def to_rest(points: NDArray[np.float64], rest: NDArray[np.float64]) -> _core.Similarity:
    """What takes a mesh that something holds turned (V x 3) to where it rests (V x 3)."""
    return _core.fit_similarity(points, rest)


def turns(
    values: NDArray[np.float64], rotation_mode: str, axes: Sequence[int] = (0,)
) -> tuple[str, NDArray[np.float64]]:
    """The property that a rotation mode reads, and its curves (N x 3 or 4), for turns (N, or N x A)
    about axes of the bone: together one turn about an axis between them."""
    vectors = np.zeros((len(values), 3))
    vectors[:, list(axes)] = TURN * np.reshape(values, (len(values), -1))
    return rotation_channels(_core.from_rotation_vectors(vectors), rotation_mode)
