# SPDX-License-Identifier: GPL-3.0-or-later
"""What a live state is on a face in a scene: values of its sliders, and its object's motion."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.gaze_shapes import look_values, turned_keys
from mimetic.character.placement import WORLD_FROM_SCENE_CAMERA
from mimetic.character.rig_motion import Channels, Motion, carried_channels
from mimetic.performance.gaze import GAZE
from mimetic.puppet.channels import channel_of
from mimetic.solve.gaze import SIDES

Floats = NDArray[np.float64]
EYE_TURN = "eye_down.L"  # one of the five shapes by which a baked face turns an eye rigidly


@dataclass(frozen=True)
class Stand:
    """Where a face's object is before a live head moves it.

    world_from_character: 4 x 4, where its head rests in the world; location: 3, rotation: 3 x 3,
    its own; units: of the world, per metre.
    """

    world_from_character: Floats
    location: Floats
    rotation: Floats
    rotation_mode: str
    units: float = 1.0


def slider_values(
    names: Sequence[str],
    values: Floats,
    lids: Sequence[_core.LidFollowing],
    sliders: Collection[str],
) -> dict[str, float]:
    """Of those of a face's `sliders` that a live state moves.

    names, values: of the state, as `live_names`; lids: how the upper ones go along with the eyes.
    """
    by_name = {name: float(value) for name, value in zip(names, values, strict=True)}
    angles = np.array([by_name.pop(name) for name in GAZE])
    for eye, side in enumerate(SIDES):
        lid, (yaw, pitch) = f"lid_upper.{side}", angles[2 * eye : 2 * eye + 2]
        by_name[lid] = float(lids[eye].seen(np.array([by_name[lid]]), np.array([pitch]))[0])
        if EYE_TURN in sliders:
            by_name |= turned_keys(side, float(np.radians(yaw)), float(np.radians(pitch)))
        else:  # sliders that look up and down carry the lids themselves
            by_name[lid] += float(lids[eye].per_degree * pitch)
            looks = look_values(side, np.array([yaw]), np.array([pitch]))
            by_name |= {name: float(value[0]) for name, value in looks.items()}
    return {name: value for name, value in by_name.items() if name in sliders}


def channel_of_slider(name: str) -> str:
    """The channel that a face's slider belongs to."""
    return channel_of("gaze_" if name.startswith(("eye_", "look_")) else name)


def head_channels(poses: Floats, rest: Floats, stand: Stand) -> Channels:
    """Curves of the face's object, moved from where it stands as the head moves from `rest`.

    poses: N x 4 x 4, rest: 4 x 4, camera from head.
    """
    every = np.concatenate([rest[None], poses])
    axes = _core.nearest_rotations(stand.world_from_character[None, :3, :3])[0]
    pivot = (stand.location - stand.world_from_character[:3, 3]) @ axes / stand.units
    world = _core.world_from_object(every, WORLD_FROM_SCENE_CAMERA)
    motion = Motion(*_core.motion_from_rest(world, 0, False, pivot))
    channels = carried_channels(
        motion,
        stand.location,
        stand.rotation,
        np.eye(4),
        axes,
        stand.rotation_mode,
        stand.units,
    )
    locations = None if channels.locations is None else channels.locations[1:]
    return Channels(channels.rotation_path, channels.rotations[1:], locations)
