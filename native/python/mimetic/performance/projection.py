# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage's own colours on the face: one frame projected onto the skin's texture."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.performance.document import Performance
from mimetic.shared.picture import picture_coordinates, picture_pixels
from mimetic.shared.pinhole import camera_of
from mimetic.shared.sampling import sampled
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
    points = np.ascontiguousarray(performance.surface_in_camera(i))
    chosen_faces = np.flatnonzero(vertex_weights[performance.faces].max(axis=1) > 0)
    face, texel, shares = _lay_out(uv[chosen_faces], chosen_faces, size)
    vertices = performance.faces[face]

    def at_texels(values: NDArray) -> NDArray:
        return np.einsum("kc,kcx->kx", shares, values[vertices])

    at = at_texels(points)
    normals = at_texels(quad_normals(points, performance.faces.astype(np.int32)))
    pixels = performance.project(at)
    weights = at_texels(vertex_weights[:, None])[:, 0] * _facing(normals, at)
    weights[~_visible(performance, points, at)] = 0
    is_seen = weights > 0.5
    if not is_seen.any():
        raise InvalidInput("the face is outside the picture in the frame chosen for its texture")
    colours = sampled(image.astype(np.float64), pixels)
    sums = np.zeros((size * size, 4))
    sums[texel, :3] = weights[:, None] * colours
    sums[texel, 3] = weights
    texture = _spread(sums.reshape(size, size, 4))
    return np.clip(texture + 0.5, 0, 255).astype(np.uint8), np.median(colours[is_seen], axis=0)


def _lay_out(uv: NDArray, faces: NDArray, size: int) -> tuple[NDArray, NDArray, NDArray]:
    """What of the mesh each texel shows: its face, its place (row-major) and its corners' shares.

    uv: W x 4 x 2 of W faces; returns K, K and K x 4.
    """
    texels = uv.reshape(-1, 2) * (size, -size) + (-0.5, size - 0.5)
    quads = np.arange(len(texels), dtype=np.int32).reshape(-1, 4)
    face, shares = _core.raster_quads(texels, np.zeros(len(texels)), quads, size, size)
    texel = np.flatnonzero(face.ravel() >= 0)
    return faces[face.ravel()[texel]], texel, shares.reshape(-1, 4)[texel].astype(np.float64)


def _facing(normals: NDArray, at: NDArray) -> NDArray:
    cosines = -(normals * at).sum(axis=1) / np.linalg.norm(at, axis=1)
    ramp = np.clip((cosines - GRAZING) / (FACING - GRAZING), 0, 1)
    return ramp * ramp * (3 - 2 * ramp)


def _visible(performance: Performance, points: NDArray, at: NDArray) -> NDArray[np.bool_]:
    """Whether points (K x 3) are inside the picture and nearest to the camera."""
    faces = np.ascontiguousarray(performance.faces, dtype=np.int32)
    camera = camera_of(performance.intrinsics, performance.image_size)
    return _core.show_points(camera, points, faces, at, BEHIND_METRES)


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
