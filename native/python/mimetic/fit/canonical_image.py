# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a face warped to the canonical head as seen from the front: whoever it is, however
it is turned, each part of the face is at the same pixel [Essa et al. 1996, figure 3].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.template.face_template import FaceTemplate, load_template

SIZE = 256  # pixels a side
MARGIN = 1.04  # of the face's height or width, whichever is larger
LEAST_FACING = 0.1  # cosine to the viewer below which a surface shows nothing
SHOWN = ("skin", "eye.L", "eye.R")
PARTS = 3  # of a pixel, along a side
MIDDLE_FIRST = (4, 1, 3, 5, 7, 0, 2, 6, 8)
UNSHOWN_REGIONS = ("scalp", "ear", "neck", "mouth_cavity", "eye_socket")


@dataclass(frozen=True, eq=False)
class CanonicalMap:
    """What of the head's control mesh each pixel of the canonical picture shows; K pixels."""

    size: int
    pixel: NDArray[np.int64]  # K, row-major
    corners: NDArray[np.int32]  # K x 4 vertices
    weights: NDArray[np.float64]  # K x 4, sum 1


def canonical_image(
    fit: FaceFit,
    image: NDArray[np.uint8],
    frame: int | None = None,
    *,
    size: int = SIZE,
    template: FaceTemplate | None = None,
) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """The face in a picture as the canonical head wears it, and where it was seen.

    image: (H, W, 3) RGB uint8, the footage's frame number `frame` (by default the fit's); the fit
    must have a view of it. returns: (size, size, 3) uint8, black where not seen; (size, size) bool.
    """
    template = template or load_template()
    width, height = fit.image_size
    if image.shape != (height, width, 3):
        raise InvalidInput(
            f"the picture is {image.shape}, the fit is for {(height, width, 3)}: it is another clip"
        )
    frame = fit.frame if frame is None else frame
    view = fit.view(frame)
    if view is None and frame != fit.frame:
        raise InvalidInput(f"the fit does not rest on frame {frame}: add it, or fit again")
    pose = fit.head_pose if view is None else view.head_pose
    canonical = canonical_map(template, size)
    vertices = fit.neutral_vertices(template) @ pose[:3, :3].T + pose[:3, 3]
    colours, is_seen = _core.seen_colours(
        *(np.ascontiguousarray(image), fit.camera, vertices),
        *(canonical.corners, canonical.weights, LEAST_FACING),
    )
    picture = np.zeros((size * size, 3), np.uint8)
    picture[canonical.pixel] = colours
    mask = np.zeros(size * size, bool)
    mask[canonical.pixel] = is_seen
    return picture.reshape(size, size, 3), mask.reshape(size, size)


@lru_cache(maxsize=4)
def canonical_map(template: FaceTemplate, size: int) -> CanonicalMap:
    """The canonical head from the front, orthographic, its face as large as fits."""
    vertices, skin = template.vertices, template.num_skin_vertices
    hidden = np.zeros(len(vertices), bool)
    hidden[:skin] = template.in_region(*UNSHOWN_REGIONS)
    faces = template.faces[template.part_faces(*SHOWN)]
    facing = np.cross(
        vertices[faces[:, 2]] - vertices[faces[:, 0]], vertices[faces[:, 3]] - vertices[faces[:, 1]]
    )
    facing /= np.linalg.norm(facing, axis=1, keepdims=True) + 1e-30
    faces = faces[~hidden[faces].all(axis=1) & (facing[:, 2] > LEAST_FACING)]
    used = vertices[np.unique(faces)]
    low, high = used[:, :2].min(axis=0), used[:, :2].max(axis=0)
    scale = size / (MARGIN * (high - low).max())
    texels = (vertices[:, :2] - (low + high) / 2) * (scale, -scale) + (size - 1) / 2
    # A pixel shows what is at its middle or else next to it: a slit between lips is no hole
    fine = (texels + 0.5) * PARTS - 0.5
    side = size * PARTS
    face, weights = _core.raster_quads(fine, vertices[:, 2], faces, side, side)
    face, weights = _parts_of_pixels(face, size), _parts_of_pixels(weights, size)
    pixel = np.flatnonzero((face >= 0).any(axis=1))
    shown = pixel, (face[pixel] >= 0).argmax(axis=1)
    return CanonicalMap(size, pixel, faces[face[shown]], weights[shown].astype(np.float64))


def _parts_of_pixels(picture: NDArray, size: int) -> NDArray:
    """The parts of each pixel of a picture drawn PARTS times as large, the middle one first."""
    split = picture.reshape(size, PARTS, size, PARTS, *picture.shape[2:]).swapaxes(1, 2)
    return split.reshape(size * size, PARTS * PARTS, *picture.shape[2:])[:, MIDDLE_FIRST]
