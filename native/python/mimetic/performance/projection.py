# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage's own colours on the face: one frame projected onto the skin's texture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput
from mimetic.performance.document import Performance
from mimetic.shared.picture import Samples, picture_coordinates, picture_pixels, sample_quads
from mimetic.skin.mesh import quad_normals

BEHIND_METRES = 0.006  # deeper than this under the nearest surface is hidden
GRAZING, FACING = 0.2, 0.5  # cosine to the viewer: no colour taken below, all of it above


def reference_index(performance: Performance) -> int:
    """Index of the frame to take colours from: well explained, facing the camera, at rest."""
    facing = -performance.head_pose[:, 2, 2]  # cosine between the face and the way to the camera
    motion = performance.activations.sum(axis=1) + np.abs(performance.articulator_values).sum(
        axis=1
    )
    return int(np.argmax(performance.quality * np.maximum(facing, 0) ** 2 / (1 + motion)))


def rescaled(pixels: ArrayLike, from_size: ArrayLike, to_size: ArrayLike) -> NDArray[np.float64]:
    """Pixels (K x 2) of a picture of one size (width, height), in the same picture at another."""
    return picture_pixels(picture_coordinates(np.reshape(pixels, (-1, 2)), from_size), to_size)


def project_uv(performance: Performance, i: int) -> NDArray[np.float64]:
    """Texture coordinates (V x 2, 0 to 1, origin bottom left) of the vertices in frame index `i`.

    The picture's edges are 0 and 1; points outside the picture lie outside that range.
    """
    pixels = performance.project(performance.surface_in_camera(i))
    return picture_coordinates(pixels, performance.image_size)


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
    Where the frame shows nothing, colours are carried over smoothly from where it does.
    returns: texture, and the median colour of what was seen (3, 0 to 255).
    """
    width, height = performance.image_size
    if image.shape != (height, width, 3):
        raise InvalidInput(
            f"the footage has frames of {image.shape[1]} x {image.shape[0]} pixels, the "
            f"performance was captured from {width} x {height}: it is another clip"
        )
    points = performance.surface_in_camera(i)
    faces = performance.faces
    chosen_faces = np.flatnonzero(vertex_weights[faces].max(axis=1) > 0)
    samples = sample_quads(uv[chosen_faces] * size, chosen_faces)
    at = samples.of(points[faces])
    pixels = performance.project(at)
    weights = samples.of(vertex_weights[faces][..., None])[:, 0]
    weights = weights * _facing(points, faces, samples, at)
    weights = weights * _visible(performance, points, at, pixels)
    texels = np.clip((samples.of(uv) * (size, -size) + (0, size)).astype(int), 0, size - 1)
    colours = _bilinear(image, pixels)
    index = texels[:, 1] * size + texels[:, 0]
    sums = np.empty((size * size, 4))
    sums[:, 3] = np.bincount(index, weights, size * size)
    for channel in range(3):
        sums[:, channel] = np.bincount(index, weights * colours[:, channel], size * size)
    hits = np.maximum(np.bincount(index, minlength=size * size), 1)
    is_seen = weights > 0.5
    if not is_seen.any():
        raise InvalidInput("the face is outside the picture in the frame chosen for its texture")
    texture = _spread((sums / hits[:, None]).reshape(size, size, 4))
    return np.clip(texture + 0.5, 0, 255).astype(np.uint8), np.median(colours[is_seen], axis=0)


def _facing(points: NDArray, faces: NDArray, samples: Samples, at: NDArray) -> NDArray:
    normals = samples.of(quad_normals(points, faces)[faces])
    cosines = -np.einsum("kd,kd->k", normals, at) / np.linalg.norm(at, axis=1)
    ramp = np.clip((cosines - GRAZING) / (FACING - GRAZING), 0, 1)
    return ramp * ramp * (3 - 2 * ramp)


def _visible(
    performance: Performance, points: NDArray, at: NDArray, pixels: NDArray
) -> NDArray[np.bool_]:
    """Whether the points are inside the picture and nearest to the camera: a depth buffer."""
    width, height = (int(side) for side in performance.image_size)
    faces = performance.faces
    everything = sample_quads(performance.project(points)[faces], np.arange(len(faces)))
    surface = everything.of(points[faces])
    depth = np.full((height, width), np.inf)
    cells, inside = _cells(performance.project(surface), width, height)
    np.minimum.at(depth.reshape(-1), cells[inside], surface[inside, 2])
    cells, inside = _cells(pixels, width, height)
    return inside & (at[:, 2] > 0) & (at[:, 2] < depth.reshape(-1)[cells] + BEHIND_METRES)


def _cells(
    pixels: NDArray[np.float64], width: int, height: int
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    nearest = np.rint(np.clip(pixels, -1, max(width, height) + 1)).astype(int)
    inside = ((nearest >= 0) & (nearest < (width, height))).all(axis=1)
    nearest = np.clip(nearest, 0, (width - 1, height - 1))
    return nearest[:, 1] * width + nearest[:, 0], inside


def _bilinear(image: NDArray, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    height, width = image.shape[:2]
    inside = np.clip(pixels, 0, (width - 1, height - 1))
    low = np.minimum(inside.astype(int), (width - 2, height - 2)).clip(min=0)
    s, t = (inside - low).T[..., None]
    x, y = low.T
    right, below = np.minimum(x + 1, width - 1), np.minimum(y + 1, height - 1)
    above = image[y, x] * (1 - s) + image[y, right] * s
    return above * (1 - t) + (image[below, x] * (1 - s) + image[below, right] * s) * t


def _spread(texture: NDArray) -> NDArray[np.float64]:
    """Fills what has little weight from its surroundings, coarse to fine (Gortler et al. 1996).

    texture: H x W x 4 with sides a power of two, colours premultiplied by the weight in the last.
    """
    levels = [texture]
    while len(levels[-1]) > 1:
        fine = levels[-1]
        coarse = fine[::2, ::2] + fine[::2, 1::2] + fine[1::2, ::2] + fine[1::2, 1::2]
        coarse /= np.maximum(coarse[..., 3:], 1)  # weights grow by gathering, up to 1
        levels.append(coarse)
    colours = levels[-1][..., :3] / np.maximum(levels[-1][..., 3:], 1e-12)
    for level in reversed(levels[:-1]):
        under = _smooth_double(colours)
        colours = level[..., :3] + (1 - np.minimum(level[..., 3:], 1)) * under
    return colours


def _smooth_double(image: NDArray) -> NDArray:
    """Twice the size, without blocks."""
    for axis in (0, 1):
        near = np.repeat(image, 2, axis=axis)
        far = np.roll(near, 1, axis=axis)
        other = np.roll(near, -1, axis=axis)
        is_even = np.arange(near.shape[axis]) % 2 == 0
        is_even = is_even.reshape((-1, 1, 1) if axis == 0 else (-1, 1))
        neighbour = np.where(is_even, far, other)
        image = 0.75 * near + 0.25 * neighbour
    return image
