# SPDX-License-Identifier: GPL-3.0-or-later
"""Which place on a performance's surface a pixel shows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.performance.document import Performance
from mimetic.shared.pinhole import camera_of
from mimetic.template.face_template import load_template

LEVELS = 2  # of refinement: facets of a millimetre or two


@dataclass(frozen=True)
class Places:
    """What K pixels show."""

    on_face: NDArray[np.bool_]  # K; pixels off it are given the nearest skin all the same
    triangle: NDArray[np.int32]  # K
    weights: NDArray[np.float64]  # K x 3, of the triangle's corners
    offset: NDArray[np.float64]  # K x 2, pixels from the place to the pixel; 0 but at outlines


class RefinedSurface:
    """The performance's limit surface, refined to small facets."""

    def __init__(self, performance: Performance) -> None:
        self.performance = performance
        self.kept_faces = _opaque(performance.faces)  # rows of the performance's
        kept = performance.faces[self.kept_faces]
        self.used, faces = np.unique(kept, return_inverse=True)
        faces = np.ascontiguousarray(faces.reshape(-1, 4), dtype=np.int32)
        self.mesh = _core.SubdividedMesh(faces, len(self.used), LEVELS)
        self.faces = np.ascontiguousarray(self.mesh.faces, dtype=np.int32)
        self.triangles = np.ascontiguousarray(_core.triangles_of(self.faces))
        self.camera = camera_of(performance.intrinsics, performance.image_size)

    def in_camera(self, i: int) -> NDArray[np.float64]:
        control = np.ascontiguousarray(self.performance.surface_in_camera(i)[self.used])
        return np.ascontiguousarray(self.mesh.positions(control))


def _opaque(faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """Rows of all faces but the lashes, which stand a centimetre before the skin behind them."""
    template = load_template()
    rows = np.arange(len(faces))
    if not np.array_equal(faces, template.faces):
        return rows
    return np.delete(rows, template.part_faces("lashes.L", "lashes.R"))


def places_under(
    surface: RefinedSurface, pixels: NDArray[np.float64], frame_index: int = 0
) -> Places | None:
    """The place that each pixel (K x 2) shows in one frame; None if no skin faces the camera."""
    pixels = np.ascontiguousarray(pixels, dtype=np.float64)
    vertices = surface.in_camera(frame_index)
    places = _core.places_under(surface.camera, vertices, surface.faces, pixels)
    return None if places is None else Places(*places)


def meets_face(
    surface: RefinedSurface, pixels: NDArray[np.float64], frame_index: int = 0
) -> NDArray[np.bool_]:
    """Which pixels (K x 2) of one frame show the face at all: `Places.on_face` of `places_under`.

    For many pixels, most of them beside the face, this is to be asked first.
    """
    pixels = np.ascontiguousarray(pixels, dtype=np.float64)
    vertices = surface.in_camera(frame_index)
    return _core.cast_rays(surface.camera, vertices, surface.triangles, pixels)[0] >= 0
