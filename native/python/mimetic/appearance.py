# SPDX-License-Identifier: GPL-3.0-or-later
"""What a captured face is painted with: surfaces for its parts, the footage on its skin."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import projection
from mimetic.face_template import FaceTemplate, load_template
from mimetic.footage import Footage
from mimetic.performance import Performance

TEXTURE_SIZE = 1024  # the face fills a third of it; footage rarely has more pixels on a face
UNSEEN_REGIONS = ("scalp", "ear", "neck", "mouth_cavity", "eye_socket")  # hair, clothes, shadows
PUPIL_DEGREES, IRIS_DEGREES = 8.0, 20.0  # quads of the eye, by their centres
PLAIN_SKIN = (0.60, 0.36, 0.27)


@dataclass(frozen=True)
class Surface:
    name: str
    colour: tuple[float, float, float]  # linear, 0 to 1
    roughness: float
    texture: NDArray[np.uint8] | None = None  # H x W x 3, sRGB, first row on top
    opacity: float = 1.0


@dataclass(frozen=True)
class Appearance:
    uv: NDArray[np.float64]  # F x 4 x 2, origin bottom left
    surfaces: list[Surface]
    surface_of_face: NDArray[np.int64]  # F


OTHERS = (
    Surface("Mouth", (0.22, 0.035, 0.03), 0.4),
    Surface("Sclera", (0.55, 0.50, 0.46), 0.2),
    Surface("Iris", (0.11, 0.085, 0.06), 0.15),
    Surface("Pupil", (0.003, 0.003, 0.003), 0.1),
    Surface("Teeth", (0.66, 0.58, 0.46), 0.3),
    Surface("Tongue", (0.38, 0.10, 0.09), 0.4),
    Surface("Lashes", (0.03, 0.02, 0.015), 0.8, opacity=0.35),
)
SURFACE_OF_PART = {
    "skin": "Skin",
    "eye_socket": "Inner Lids",
    "mouth_cavity": "Mouth",
    "eye.L": "Sclera",
    "eye.R": "Sclera",
    "teeth_upper": "Teeth",
    "teeth_lower": "Teeth",
    "tongue": "Tongue",
    "lashes.L": "Lashes",
    "lashes.R": "Lashes",
}


def appearance_of(
    performance: Performance,
    footage: str | os.PathLike[str] | None = None,
    frame: int | None = None,
) -> Appearance | None:
    """Paint for the performance's face; None if it is not our own head's mesh.

    footage: the clip it was captured from, for the skin's texture; plain skin without. frame: the
    footage frame to take colours from, the best one if None.
    """
    template = load_template()
    if not np.array_equal(template.faces, performance.faces):
        return None
    uv = _fill_square(template)
    skin = Surface("Skin", PLAIN_SKIN, 0.5)
    if footage is not None:
        if frame is None:
            i = projection.reference_index(performance)
        else:
            i = performance.index_of(frame)
        image = Footage(footage).read(int(performance.frame[i]))
        weights = _vertex_weights(template)
        texture, colour = projection.project_texture(
            performance, i, image, uv, weights, TEXTURE_SIZE
        )
        skin = Surface("Skin", tuple(_linear(colour / 255).tolist()), 0.55, texture)
    inner_lids = Surface("Inner Lids", tuple(0.6 * part for part in skin.colour), 0.5)
    surfaces = [skin, inner_lids, *OTHERS]
    return Appearance(uv, surfaces, _surface_of_face(template, [s.name for s in surfaces]))


def _vertex_weights(template: FaceTemplate) -> NDArray[np.float64]:
    unseen = [list(template.region_names).index(name) for name in UNSEEN_REGIONS]
    weights = np.zeros(len(template.vertices))
    weights[: template.num_skin_vertices] = ~np.isin(template.region, unseen)
    faces = template.faces[: template.num_skin_faces]
    wanted = weights.copy()
    counts = np.bincount(faces.reshape(-1), minlength=len(weights))
    for _ in range(2):  # the border becomes a ramp of two quads, inwards
        around = weights[faces].mean(axis=1)
        sums = np.bincount(faces.reshape(-1), np.repeat(around, 4), len(weights))
        weights = np.minimum(wanted, sums / np.maximum(counts, 1))
    return weights


def _surface_of_face(template: FaceTemplate, names: list[str]) -> NDArray[np.int64]:
    of_part = [names.index(SURFACE_OF_PART[str(part)]) for part in template.part_names]
    surface = np.array(of_part)[template.part]
    centres = template.vertices[template.faces].mean(axis=1)
    for side, eye in enumerate(("eye.L", "eye.R")):
        away = centres - template.eye_centers[side]
        degrees = np.degrees(np.arccos(away[:, 2] / np.linalg.norm(away, axis=1)))
        is_eye = template.part == list(template.part_names).index(eye)
        surface[is_eye & (degrees < IRIS_DEGREES)] = names.index("Iris")
        surface[is_eye & (degrees < PUPIL_DEGREES)] = names.index("Pupil")
    return surface


def _fill_square(template: FaceTemplate) -> NDArray[np.float64]:
    """The template's texture coordinates with the skin filling the square, for the most texels."""
    uv = np.asarray(template.uv, dtype=np.float64)
    skin = uv[template.part == list(template.part_names).index("skin")].reshape(-1, 2)
    low, high = skin.min(axis=0), skin.max(axis=0)
    return 0.01 + 0.98 * (uv - low) / (high - low)


def _linear(colour: NDArray) -> NDArray:
    """Linear light of sRGB values, both 0 to 1 (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
