# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of a fitted face as lines over its frame."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.shared.picture import picture_coordinates
from mimetic.template.face_template import load_template

LEFT_OUT = ("neck", "ear", "mouth_cavity", "eye_socket", "scalp")
FACING = 0.1  # cosine to the viewer from which on a quad's lines are drawn


def fit_lines(fit: FaceFit, frame: int | None = None) -> NDArray[np.float64]:
    """Lines (K x 2 x 2) of the mesh where it faces the camera, as parts of the picture.

    0 to 1 from edge to edge, from the bottom left. frame: one of the fit's views, by default its
    reference; without such a view there are no lines.
    """
    frame = fit.frame if frame is None else frame
    view = fit.view(frame)
    pose = view.head_pose if view else fit.head_pose if frame == fit.frame else None
    if pose is None:
        return np.zeros((0, 2, 2))
    template = load_template()
    vertices = fit.neutral_vertices(template) @ pose[:3, :3].T + pose[:3, 3]
    edges = _core.facing_edges(vertices, _skin(), FACING)
    pixels = vertices @ fit.intrinsics.T
    places = picture_coordinates(pixels[:, :2] / pixels[:, 2:], fit.image_size)
    return places[edges]


@lru_cache(maxsize=1)
def _skin() -> NDArray[np.int32]:
    template = load_template()
    faces = np.asarray(template.skin_faces)
    return faces[~template.in_region(*LEFT_OUT)[faces].any(axis=1)]
