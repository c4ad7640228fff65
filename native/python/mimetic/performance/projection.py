# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage's own colours on the face: one frame projected onto the skin's texture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.document import Performance
from mimetic.performance.gaze import expression_of
from mimetic.shared.picture import picture_coordinates, picture_pixels
from mimetic.shared.pinhole import camera_of
from mimetic.skin.mesh import quad_normals

START = 1.0  # seconds of the footage whose frames are badly compressed
NEARLY = 0.9  # of how well the best frame suits


def reference_index(performance: Performance) -> int:
    """Index of the frame in which the face is best seen: well explained, facing us, at rest."""
    return int(np.argmax(_suits(performance)))


def colour_index(performance: Performance) -> int:
    """Index of the frame to take colours from: as `reference_index`, but not at a clip's start.

    Encoders spend little on it: the first frames of many clips are blocks of one colour.
    """
    suits = _suits(performance)
    late = np.where(performance.frame > START * performance.fps, suits, 0.0)
    return int(np.argmax(late if late.max() > NEARLY * suits.max() else suits))


def _suits(performance: Performance) -> NDArray[np.float64]:
    """N, 0 to 1."""
    facing = -performance.head_pose[:, 2, 2]  # cosine between the face and the way to the camera
    motion = performance.activations.sum(axis=1) + np.abs(expression_of(performance)).sum(axis=1)
    return performance.quality * np.maximum(facing, 0) ** 2 / (1 + motion)


def rescaled(pixels: ArrayLike, from_size: ArrayLike, to_size: ArrayLike) -> NDArray[np.float64]:
    """Pixels (K x 2) of a picture of one size (width, height), in the same picture at another."""
    return picture_pixels(picture_coordinates(np.reshape(pixels, (-1, 2)), from_size), to_size)


def project_texture(
    performance: Performance,
    i: int,
    image: NDArray[np.uint8],
    uv: NDArray,
    vertex_weights: NDArray,
    size: int,
) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """A texture (size x size x 3, first row on top) with a frame's colours, and the skin's.

    i: index of the frame that `image` (H x W x 3 RGB) shows; uv: F x 4 x 2, origin bottom left;
    vertex_weights: V, 0 where the frame's colours are not wanted (hair, the eyes' sockets) to 1.
    size: a power of two. Where the frame shows nothing, colours are carried over smoothly from
    where it does.
    returns: texture, and the median colour of what was seen (3, 0 to 255).
    """
    width, height = performance.image_size
    if image.shape != (height, width, 3):
        raise InvalidInput(
            f"the footage has frames of {image.shape[1]} x {image.shape[0]} pixels, the "
            f"performance was captured from {width} x {height}: it is another clip"
        )
    points = np.ascontiguousarray(performance.surface_in_camera(i))
    faces = performance.faces.astype(np.int32)
    camera = camera_of(performance.intrinsics, performance.image_size)
    normals, corners = quad_normals(points, faces), uv.reshape(-1, 2)
    picture = np.ascontiguousarray(image)
    return _core.project_texture(
        camera, picture, points, normals, faces, corners, size, vertex_weights
    )
