# SPDX-License-Identifier: GPL-3.0-or-later
"""What a captured face is painted with: surfaces for its parts, the footage on its skin."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.character import face_paint
from mimetic.media.footage import Footage
from mimetic.performance import projection
from mimetic.performance.document import Performance
from mimetic.performance.gaze import SIDES
from mimetic.template.face_template import FaceTemplate, load_template

TEXTURE_SIZE = 1024  # the face fills a third of it; footage rarely has more pixels on a face
EYE_SIZE, LASHES_SIZE = 256, (512, 128)
DARKEST_EYES = 0.3  # of the painted ones: what is seen of nearly closed eyes is lids
IRIS_WIDTH, NARROWEST_IRIS = 0.0117, 6.0  # metres (horizontal visible iris diameter), pixels
IRIS_RING = face_paint.PUPIL + 2.0, face_paint.IRIS - 3.5  # degrees, where its colour is read
IRIS_LEVELS = 0.08, 0.7  # sRGB of the darkest and the palest
# Of the mouth, linear, 0 to 1; and how bright it is seen for the light on the eyes' whites, which
# sockets shade: of teeth as in two filmed clips, what lies behind them is darker
INSIDE = {
    "Mouth": ((0.22, 0.035, 0.03), 0.8),
    "Teeth": ((0.66, 0.58, 0.50), 1.4),
    "Tongue": ((0.38, 0.10, 0.09), 0.85),
}
UNSEEN_REGIONS = ("scalp", "ear", "neck", "mouth_cavity", "eye_socket")  # hair, clothes, shadows


@dataclass(frozen=True)
class Surface:
    name: str
    colour: tuple[float, float, float]  # linear, 0 to 1
    roughness: float
    texture: NDArray[np.uint8] | None = None  # H x W x 3 or 4, sRGB, first row on top


@dataclass(frozen=True)
class Appearance:
    uv: NDArray[np.float64]  # F x 4 x 2, origin bottom left
    surfaces: list[Surface]
    surface_of_face: NDArray[np.int64]  # F


SURFACE_OF_PART = {
    "skin": "Skin",
    "eye_socket": "Inner Lids",
    "mouth_cavity": "Mouth",
    "eye.L": "Eyes",
    "eye.R": "Eyes",
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

    footage: the clip it was captured from, for the skin's texture; painted skin without. frame: the
    footage frame to take colours from, the best one if None.
    """
    template = load_template()
    if not np.array_equal(template.faces, performance.faces):
        return None
    if footage is None:
        return painted(template)
    uv = face_paint.fill_square(template)
    if frame is None:
        frame = int(performance.frame[projection.colour_index(performance)])
    i, image = performance.index_of(frame), Footage(footage).read(frame)
    weights = _vertex_weights(template)
    texture, colour = projection.project_texture(performance, i, image, uv, weights, TEXTURE_SIZE)
    light = light_on_eyes(performance, i, image, template, uv)
    iris = iris_colour(performance, i, image, template, uv, light)
    return _appearance(template, uv, texture, colour, light, iris)


@lru_cache(maxsize=1)
def painted(template: FaceTemplate) -> Appearance:
    """Paint for a head that was never filmed, always the same: its arrays are read-only."""
    uv = face_paint.fill_square(template)
    texture = _bytes(face_paint.paint_skin(template, uv, TEXTURE_SIZE))
    appearance = _appearance(template, uv, texture, 255 * face_paint.SKIN)
    arrays: list[NDArray] = [appearance.uv, appearance.surface_of_face]
    arrays += [surface.texture for surface in appearance.surfaces if surface.texture is not None]
    for array in arrays:
        array.flags.writeable = False
    return appearance


def _appearance(
    template: FaceTemplate,
    uv: NDArray,
    texture: NDArray[np.uint8],
    colour: NDArray,
    light_on_eyes: NDArray | None = None,
    iris_colour: NDArray = face_paint.BROWN,
) -> Appearance:
    eyes = face_paint.paint_eye(EYE_SIZE, iris_colour)
    inside = {name: row[0] for name, row in INSIDE.items()}
    if light_on_eyes is not None:
        eyes, inside = eyes * light_on_eyes, _inside_as_filmed(light_on_eyes)
    surfaces = _surfaces(texture, _linear(colour / 255), _bytes(eyes), inside)
    names = [surface.name for surface in surfaces]
    of_part = [names.index(SURFACE_OF_PART[str(part)]) for part in template.part_names]
    return Appearance(uv, surfaces, np.array(of_part)[template.part])


def light_on_eyes(
    performance: Performance, i: int, image: NDArray[np.uint8], template: FaceTemplate, uv: NDArray
) -> NDArray[np.float64]:
    """Of three colours, how bright the eyes' whites are seen to those that are painted, up to 1.

    Sockets and lids shade them: as white as painted they would glare.
    """
    weights = np.zeros(len(template.vertices))
    for side in SIDES:
        eye = np.asarray(template.part_vertices(f"eye.{side}"))
        depth = template.vertices[eye, 2] - template.vertices[eye, 2].mean()
        ahead = depth / depth.max()  # cosine of the angle from the pupil
        weights[eye] = (ahead < np.cos(np.radians(face_paint.IRIS + 5.0))) & (ahead > 0.5)
    try:
        _, seen = projection.project_texture(performance, i, image, uv, weights, EYE_SIZE)
    except InvalidInput:  # no white is seen
        return np.ones(3)
    light = np.clip(seen / 255 / face_paint.SCLERA, DARKEST_EYES, 1)
    # The rims of lids are in these few pixels, redder than the whites: half of the tint is theirs
    return np.sqrt(light * light.max())


def iris_colour(
    performance: Performance,
    i: int,
    image: NDArray[np.uint8],
    template: FaceTemplate,
    uv: NDArray,
    light: NDArray,
) -> NDArray[np.float64]:
    """Of both eyes, sRGB: what is seen as filmed under the light on the eyes; brown where eyes are
    too small in the picture or not seen."""
    eyes = template.part_vertices(*(f"eye.{side}" for side in SIDES))
    depth = performance.surface_in_camera(i)[eyes, 2].mean()
    if performance.intrinsics[0, 0] * IRIS_WIDTH < NARROWEST_IRIS * depth:
        return face_paint.BROWN
    weights = np.zeros(len(template.vertices))
    weights[eyes] = 1.0
    try:
        seen, _ = projection.project_texture(performance, i, image, uv, weights, EYE_SIZE)
    except InvalidInput:
        return face_paint.BROWN
    degrees, _ = face_paint.eye_angles(EYE_SIZE)
    is_iris = (degrees > IRIS_RING[0]) & (degrees < IRIS_RING[1])
    return np.clip(np.median(seen[is_iris], axis=0) / 255 / light, *IRIS_LEVELS)


def _inside_as_filmed(light: NDArray) -> dict[str, tuple[float, float, float]]:
    """Colours of the mouth's inside, linear, under the light that is seen on the eyes' whites.

    The skin's texture has the light and the shadows of the footage in it: teeth as white as painted
    would glare between its lips. Skin itself may be dark in bright light.
    """
    return {
        name: _triple(_linear(np.clip(share * light, 0, 1) * srgb(np.array(colour))))
        for name, (colour, share) in INSIDE.items()
    }


def _surfaces(
    skin: NDArray[np.uint8],
    colour: NDArray,
    eyes: NDArray[np.uint8],
    inside: dict[str, tuple[float, float, float]],
) -> list[Surface]:
    """All surfaces, from the skin's texture, its colour in linear light, the eyes' texture and the
    colours of INSIDE."""
    lashes = _bytes(face_paint.paint_lashes(*LASHES_SIZE))
    return [
        Surface("Skin", _triple(colour), 0.55, skin),
        Surface("Inner Lids", _triple(0.6 * colour), 0.5),
        Surface("Mouth", inside["Mouth"], 0.4),
        Surface("Eyes", (0.55, 0.50, 0.46), 0.15, eyes),
        Surface("Teeth", inside["Teeth"], 0.3),
        Surface("Tongue", inside["Tongue"], 0.4),
        Surface("Lashes", _triple(_linear(face_paint.LASH)), 0.8, lashes),
    ]


def _vertex_weights(template: FaceTemplate) -> NDArray[np.float64]:
    unseen_regions = [list(template.region_names).index(name) for name in UNSEEN_REGIONS]
    weights = np.zeros(len(template.vertices))
    weights[: template.num_skin_vertices] = ~np.isin(template.region, unseen_regions)
    faces = template.faces[: template.num_skin_faces]
    full_weights = weights.copy()
    counts = np.bincount(faces.reshape(-1), minlength=len(weights))
    for _ in range(2):  # the border becomes a ramp of two quads, inwards
        around = weights[faces].mean(axis=1)
        sums = np.bincount(faces.reshape(-1), np.repeat(around, 4), len(weights))
        weights = np.minimum(full_weights, sums / np.maximum(counts, 1))
    return weights


def _bytes(picture: NDArray) -> NDArray[np.uint8]:
    return (np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8)


def _triple(colour: NDArray) -> tuple[float, float, float]:
    red, green, blue = (float(part) for part in colour)
    return red, green, blue


def srgb(light: NDArray) -> NDArray:
    """sRGB of linear light, both 0 to 1 (IEC 61966-2-1)."""
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def _linear(colour: NDArray) -> NDArray:
    """Linear light of sRGB values, both 0 to 1 (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
