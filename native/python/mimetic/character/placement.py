# SPDX-License-Identifier: GPL-3.0-or-later
"""Head motion and camera in a scene whose z points up and whose characters face -y.

Frames: *head* and *camera* as in `Performance`; *object*, the face's own frame in such a scene:
x to the person's left, z up, the face towards -y, origin midway between the ears; *scene camera*:
x right, y up, looking along -z; *world*, the scene. Metres.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic._core import OBJECT_FROM_HEAD, quaternions
from mimetic.performance.document import Performance
from mimetic.shared.pinhole import FULL_FRAME_MM

# A camera at the world's origin that looks along +y, level: a head facing it stands upright
WORLD_FROM_SCENE_CAMERA = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])


@dataclass(frozen=True)
class HeadMotion:
    quaternions: NDArray[np.float64]  # N x 4, w x y z, signs without jumps from frame to frame
    locations: NDArray[np.float64]  # N x 3, metres


@dataclass(frozen=True)
class Lens:
    """A pinhole camera as a lens: see `lens`."""

    fit: str  # HORIZONTAL or VERTICAL: the side of the picture that sensor and shifts refer to
    focal_mm: float
    sensor_mm: float
    shift_x: float  # of the picture's fitted side; positive moves the window right
    shift_y: float  # positive moves the window up
    covered: tuple[float, float]  # parts of the picture's width and height that the footage takes


def to_object(points: ArrayLike) -> NDArray[np.float64]:
    """Points or displacements (... x 3) of the head frame in the object's frame."""
    return np.asarray(points, dtype=np.float64) @ OBJECT_FROM_HEAD[:3, :3].T


def to_head(points: ArrayLike) -> NDArray[np.float64]:
    """Points or displacements (... x 3) of the object's frame in the head frame."""
    return np.asarray(points, dtype=np.float64) @ OBJECT_FROM_HEAD[:3, :3]


def head_motion(
    performance: Performance, world_from_scene_camera: ArrayLike = WORLD_FROM_SCENE_CAMERA
) -> HeadMotion:
    """The face object's motion in the world, before a camera that stands still."""
    poses = world_from_object(performance, world_from_scene_camera)
    return HeadMotion(quaternions(poses[:, :3, :3]), poses[:, :3, 3].copy())


def world_from_object(
    performance: Performance, world_from_scene_camera: ArrayLike = WORLD_FROM_SCENE_CAMERA
) -> NDArray[np.float64]:
    """N x 4 x 4 poses of the face object. A camera's scale does not count, as in its picture."""
    world = np.array(world_from_scene_camera, dtype=np.float64)
    if world.shape != (4, 4):
        raise InvalidInput("the camera's matrix is not 4 x 4, or flat; reset its scale")
    return _core.world_from_object(performance.head_pose, world)


def lens(
    intrinsics: ArrayLike,
    image_size: ArrayLike,
    picture_size: ArrayLike | None = None,
    pixel_aspect: float = 1.0,
    sensor_mm: float | None = None,
) -> Lens:
    """The lens under which a scene's picture shows footage fitted whole into it.

    intrinsics: 3 x 3, pixels; image_size: of the footage; picture_size: of the scene's pictures,
    the footage's if None; pixel_aspect: a picture pixel's height over its width; sensor_mm: width
    of the sensor that the footage was filmed with, if it is known.
    """
    (fx, _, cx), (_, fy, cy), _ = np.asarray(intrinsics, dtype=np.float64)
    width, height = (float(side) for side in np.asarray(image_size))
    if abs(fy / fx - 1) > 1e-3:
        raise InvalidInput(
            f"the footage's pixels are not square (focal lengths {fx:.1f} and {fy:.1f}); "
            "convert it to square pixels first"
        )
    picture = np.asarray((width, height) if picture_size is None else picture_size, dtype=float)
    is_wider = picture[0] > picture[1] * pixel_aspect * width / height * (1 + 1e-9)
    side = height if is_wider else width
    sensor = FULL_FRAME_MM if sensor_mm is None else sensor_mm * side / width
    widths = width / height / (picture[0] / (picture[1] * pixel_aspect))  # footage's to picture's
    return Lens(
        fit="VERTICAL" if is_wider else "HORIZONTAL",
        focal_mm=fx * sensor / side,
        sensor_mm=sensor,
        # Pixel (0, 0) is a pixel's centre: the picture's edge lies half a pixel further out
        shift_x=(width / 2 - (cx + 0.5)) / side,
        shift_y=((cy + 0.5) - height / 2) / side,
        covered=(min(1.0, float(widths)), min(1.0, float(1 / widths))),
    )
