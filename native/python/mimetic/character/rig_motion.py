# SPDX-License-Identifier: GPL-3.0-or-later
"""A head's motion on other things: objects, and bones of any armature.

*Character* frame: as the object frame of `placement`, x to the character's left, z up, the face
towards -y. A turn in it is read by rest axes of the thing that takes it, so that a character looks
to its own left when the actor does, however its bones lie. Metres unless said otherwise.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic._core import axis_angles, euler_angles, quaternions, rotation_of
from mimetic.character.placement import WORLD_FROM_SCENE_CAMERA, world_from_object
from mimetic.performance.document import Performance
from mimetic.performance.projection import reference_index

# Where a thing's own face looks, as turns about z from -y
FACINGS = {"-Y": 0.0, "+X": 0.5 * np.pi, "+Y": np.pi, "-X": -0.5 * np.pi}

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """Turns and shifts of the head in the character frame, frame by frame."""

    rotations: Floats  # N x 3 x 3
    shifts: Floats  # N x 3


@dataclass(frozen=True)
class Channels:
    """What curves hold: see `rotation_channels`."""

    rotation_path: str  # rotation_quaternion, rotation_euler or rotation_axis_angle
    rotations: Floats  # N x 4 or N x 3
    locations: Floats | None  # N x 3, in the target's own units


@dataclass(frozen=True)
class Bone:
    """A bone as its armature has it at rest."""

    rest: Floats  # 3 x 3, armature from bone
    rotation_mode: str
    can_move: bool = True  # a connected bone takes no location
    is_local: bool = True  # its location is along its own axes, not the armature's


def motion(
    performance: Performance,
    is_absolute: bool = False,
    rest_frame: int | None = None,
    pivot: ArrayLike = (0.0, 0.0, 0.0),
) -> Motion:
    """The head's motion against one of its frames, or against a head that faces the camera.

    is_absolute: turns are 0 where the head faces the camera straight; otherwise in the rest
    frame, in the axes that the head has there. Shifts are 0 there in both.
    rest_frame: a footage frame; None takes the one in which the head is best seen, straight
    and at rest. pivot: the point whose shifts are given, in the character frame from midway between
    the ears. Raises InvalidInput for a frame that the performance lacks.
    """
    rest = rest_index(performance, rest_frame)
    poses = world_from_object(performance)
    return Motion(*_core.motion_from_rest(poses, rest, is_absolute, np.asarray(pivot)))


def rest_index(performance: Performance, rest_frame: int | None = None) -> int:
    """Index of the frame in which a target is as it was: see `motion`."""
    if rest_frame is None:
        return reference_index(performance)
    return performance.index_of(rest_frame)


def facing(direction: str) -> Floats:
    """3 x 3: the axes of a thing whose face looks along `direction`, one of FACINGS, from ours."""
    if direction not in FACINGS:
        raise InvalidInput(f"facing {direction!r}; there are {', '.join(FACINGS)}")
    angle = FACINGS[direction]
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])


def bone_channels(
    head_motion: Motion,
    head: Bone,
    neck: Bone | None = None,
    neck_share: float = 0.0,
    followed_share: float = 1.0,
    direction: str = "-Y",
    units: float = 1.0,
) -> tuple[Channels, Channels | None]:
    """Curves of a head's bone and of its neck's, from rest, that turn the head as the actor's.

    neck_share: part of each turn that the neck takes; followed_share: part of the neck's turn that
    reaches the head by the armature itself (1 for a child, 0 where the head keeps its orientation):
    see `followed`. direction: where the armature's face looks; units: of its space, per metre.
    """
    if not 0 <= neck_share <= 1:
        raise InvalidInput(f"neck share is {neck_share}; it lies in 0 to 1")
    rotations, locations, of_neck = _core.bone_motion(
        rotations=head_motion.rotations,
        shifts=head_motion.shifts,
        head_rest=head.rest,
        neck_rest=None if neck is None else neck.rest,
        axes=facing(direction),
        neck_share=neck_share,
        followed_share=followed_share,
        is_local=head.is_local,
        units=units,
    )
    of_head = _channels(rotations, locations if head.can_move else None, head.rotation_mode)
    return of_head, None if neck is None else _channels(of_neck, None, neck.rotation_mode)


def axes_of(world_from_object: ArrayLike, direction: str = "-Y") -> Floats:
    """3 x 3, world from the character frame, of an object whose face looks along `direction`.

    world_from_object: 4 x 4. A mirrored object holds a face still, whose left is where its right
    was. Raises InvalidInput for one that is scaled to nothing.
    """
    linear = np.asarray(world_from_object, dtype=np.float64)[:3, :3]
    axes = linear @ facing(direction) / (np.abs(linear).max() or 1.0)
    return rotation_of(axes @ mirror(axes), "object")


def mirror(linear: Floats) -> Floats:
    """3 x 3, with which a mirroring matrix mirrors no more: it turns over x, from side to side."""
    x, y, z = linear.T
    return np.diag([-1.0 if np.cross(x, y) @ z < 0 else 1.0, 1, 1])


def carried_channels(
    head_motion: Motion,
    location: ArrayLike,
    rotation: ArrayLike,
    world_from_parent: ArrayLike,
    axes: ArrayLike,
    rotation_mode: str,
    scale: float = 1.0,
) -> Channels:
    """Curves of an object that starts from where it is and moves as the head does.

    location: 3, rotation: 3 x 3, its own channels now; world_from_parent: 4 x 4; axes: 3 x 3, world
    from the character frame; scale: of shifts.
    """
    rotations, locations = _core.carry_object(
        head_motion.rotations,
        head_motion.shifts,
        location,
        rotation,
        world_from_parent,
        axes,
        scale,
    )
    return _channels(rotations, locations, rotation_mode)


def placed_channels(
    performance: Performance,
    world_from_parent: ArrayLike,
    rotation_mode: str,
    world_from_scene_camera: ArrayLike | None = None,
    direction: str = "-Y",
    scale: float = 1.0,
) -> Channels:
    """Curves that put an object where the head is before the footage's camera.

    scale: of the distance to the camera, as for a character larger than its actor. Under a mirrored
    parent the head is upright, its left where its right was.
    """
    world = WORLD_FROM_SCENE_CAMERA if world_from_scene_camera is None else world_from_scene_camera
    poses = world_from_object(performance, world)
    camera = np.asarray(world, dtype=np.float64)[:3, 3]
    axes = facing(direction)
    rotations, locations = _core.place_object(poses, camera, world_from_parent, axes, scale)
    return _channels(rotations, locations, rotation_mode)


def followed(before: ArrayLike, after: ArrayLike, angle: float) -> float:
    """The part (0 to 1) of a turn by `angle` radians that took `before` to `after` (3 x 3)."""
    return float(np.clip(_core.turn_between(before, after) / angle, 0, 1))


def _channels(rotations: Floats, locations: Floats | None, rotation_mode: str) -> Channels:
    path, values = rotation_channels(rotations, rotation_mode)
    return Channels(path, values, locations)


def rotation_channels(rotations: Floats, rotation_mode: str) -> tuple[str, Floats]:
    """The property that a rotation mode reads, and its values without jumps."""
    if rotation_mode == "QUATERNION":
        return "rotation_quaternion", quaternions(rotations)
    if rotation_mode == "AXIS_ANGLE":
        return "rotation_axis_angle", axis_angles(rotations)
    return "rotation_euler", euler_angles(rotations, rotation_mode)
