# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of a face warped to the canonical head as seen from the front: whoever it is, however
it is turned, each part of the face is at the same pixel [Essa et al. 1996, figure 3].
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.template.face_template import FaceTemplate, load_template

SIZE = 256  # pixels a side
LEAST_FACING = 0.1  # cosine to the viewer below which a surface shows nothing
SHOWN = ("skin", "eye.L", "eye.R")
UNSHOWN_REGIONS = ("scalp", "ear", "neck", "mouth_cavity", "eye_socket")


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
        *(canonical, LEAST_FACING),
    )
    picture = np.zeros((size * size, 3), np.uint8)
    picture[canonical.pixel] = colours
    mask = np.zeros(size * size, bool)
    mask[canonical.pixel] = is_seen
    return picture.reshape(size, size, 3), mask.reshape(size, size)


@lru_cache(maxsize=4)
def canonical_map(template: FaceTemplate, size: int) -> _core.CanonicalPixels:
    """What of the canonical head each pixel shows, from the front, its face as large as fits."""
    is_hidden = np.zeros(len(template.vertices), bool)
    is_hidden[: template.num_skin_vertices] = template.in_region(*UNSHOWN_REGIONS)
    faces = template.faces[template.part_faces(*SHOWN)]
    return _core.canonical_pixels(template.vertices, faces, is_hidden.tolist(), size, LEAST_FACING)
