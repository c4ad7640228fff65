# SPDX-License-Identifier: GPL-3.0-or-later
"""Footage and baked face side by side, from the same camera: whole, and the face enlarged."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.appearance import SURFACE_OF_PART, Appearance, appearance_of, srgb
from mimetic.character.contact_shapes import contact_shapes
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.shared.pinhole import camera_of
from mimetic.shared.progress import Progress
from mimetic.template.face_template import FaceTemplate, load_template

SMALLEST, LARGEST = 640, 960  # pixels of a view's longer side
ENLARGED = 1.5  # of the view's shorter side over the face from brows to chin
STEADY = 0.4  # seconds: how slowly the enlarged part follows the face
INSIDE = ("mouth_cavity", "teeth_upper", "teeth_lower", "tongue")
INTO_THE_MOUTH = 0.04  # metres behind the lips at which 1/e of the light is left
IN_THE_SHADE = 0.12  # of the light, at the back of the mouth
TOUCHING = 0.002  # metres between the lips' inner landmarks where they touch
SLIT, OPEN = 0.15, 0.008  # of that light between lips that touch; metres apart for all of it
GAUGE = 22  # rows below the views
COARSER = 4  # texels of lashes in one
PLAIN = (200, 168, 148)  # of a mesh that is not our own head's


def baked(
    performance: Performance, with_detail: bool = False, progress: Progress | None = None
) -> Performance:
    """The performance with what a bake makes of its surface: contact, detail if it is wanted.

    Contact comes as detail.
    """
    if not with_detail:
        performance = performance.without_detail()
    shapes = contact_shapes(performance, progress)
    if not shapes:
        return performance
    modes = np.array([shape.offsets for shape in shapes], dtype=np.float32)
    values = np.array([shape.values for shape in shapes]).T
    if performance.detail_modes is not None and performance.detail_coefficients is not None:
        modes = np.concatenate([performance.detail_modes, modes])
        values = np.hstack([performance.detail_coefficients, values])
    return replace(
        performance, detail_modes=modes, detail_coefficients=values, detail_coefficients_std=None
    )


class BesideDrawing:
    """Paints frames of a performance; `paint(image, i)` gives two views of the footage at the left,
    the same two of the face at the right.

    performance: what `baked` gives. footage: the clip, for the skin's colours. Raises InvalidInput
    if it is another.
    """

    def __init__(self, performance: Performance, footage: str | os.PathLike[str]) -> None:
        self.performance = performance
        self.camera = camera_of(performance.intrinsics, performance.image_size)
        appearance = appearance_of(performance, footage)
        self.surface, self.vertices = _painted(performance, appearance)
        self.inside = _inside(appearance)
        longer = max(performance.image_size)
        scale = float(np.clip(longer, SMALLEST, LARGEST) / longer)
        # H.264 has even sides only
        self.width, self.height = (2 * round(scale * side / 2) for side in performance.image_size)
        middle = (np.array(performance.image_size) - 1) / 2
        self.whole = _core.reframed_camera(self.camera, middle, scale, self.width, self.height)
        self.centres, self.scales = self._enlarged()

    def paint(self, image: NDArray[np.uint8], i: int) -> NDArray[np.uint8]:
        width, height = self.performance.image_size
        if image.shape[:2] != (height, width):
            raise InvalidInput(
                f"the footage has frames of {image.shape[1]} x {image.shape[0]} pixels, the "
                f"performance was captured from {width} x {height}: it is another clip"
            )
        image = np.ascontiguousarray(image)
        points = np.ascontiguousarray(self.performance.surface_in_camera(i)[self.vertices])
        near = _core.reframed_camera(
            *(self.camera, self.centres[i], float(self.scales[i]), self.width, self.height)
        )
        light = self._light(points)
        rows = [
            np.hstack(
                [
                    _core.reframed_picture(image, self.camera, camera),
                    self.surface.draw(camera, points, light),
                ]
            )
            for camera in (self.whole, near)
        ]
        quality, frame = float(self.performance.quality[i]), int(self.performance.frame[i])
        strip = np.zeros((GAUGE, 2 * self.width, 3), dtype=np.uint8)
        rows.append(_core.with_gauge(strip, quality, HELD_QUALITY, frame))
        return np.ascontiguousarray(np.vstack(rows))

    def _light(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of each surface: lips that are hardly apart leave the mouth dark. points: V x 3."""
        light = np.ones(len(self.inside))
        if self.inside.any():
            template = load_template()
            upper, lower = (template.landmark(f"lip_{lip}_inner") for lip in ("upper", "lower"))
            apart = np.sqrt(((points[upper] - points[lower]) ** 2).sum())
            light[self.inside] = SLIT + (1 - SLIT) * np.clip((apart - TOUCHING) / OPEN, 0, 1)
        return light

    def _enlarged(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """N x 2 pixels that the enlarged views have in their middle, and how large they are."""
        performance = self.performance
        top, bottom = _brows_and_chin(performance)
        middle = 0.5 * (top + bottom)
        poses = performance.head_pose
        places = poses[:, :3, :3] @ middle + poses[:, :3, 3]
        pixels = performance.project(places)
        face = performance.intrinsics[1, 1] * (top - bottom)[1] / places[:, 2]  # pixels
        scales = min(self.width, self.height) / (ENLARGED * face)
        steady = np.column_stack([pixels, scales])
        frames = performance.frame.astype(np.float64)
        for k in range(3):
            steady[:, k], _ = _core.smooth_curve(
                *(frames, np.ascontiguousarray(steady[:, k]), frames, STEADY * performance.fps)
            )
        return np.ascontiguousarray(steady[:, :2]), steady[:, 2]


def _brows_and_chin(performance: Performance) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Two places of the neutral face, metres; of another mesh than our own, of all of it."""
    neutral = performance.neutral_vertices
    template = _template_of(performance)
    if template is None:
        middle = 0.5 * (neutral.min(axis=0) + neutral.max(axis=0))
        half = np.array([0.0, 0.5 * np.ptp(neutral[:, 1]), 0.0])
        return middle + half, middle - half
    brows = neutral[[template.landmark(f"brow_middle.{side}") for side in "LR"]].mean(axis=0)
    return brows, neutral[template.landmark("menton")]


def _painted(
    performance: Performance, appearance: Appearance | None
) -> tuple[_core.PaintedSurface, NDArray[np.int64]]:
    """What draws the face, and the vertices that it takes."""
    vertices, faces = np.unique(performance.faces, return_inverse=True)
    faces = np.ascontiguousarray(faces.reshape(-1, 4), dtype=np.int32)
    brightness = np.ones(len(vertices))
    template = _template_of(performance)
    if appearance is None or template is None:
        corners, of_face = np.zeros((4 * len(faces), 2)), np.zeros(len(faces), dtype=np.int32)
        surface = _core.PaintedSurface(faces, [_plain(PLAIN)], of_face, corners, brightness)
        return surface, vertices
    brightness = _brightness(performance, template)[vertices]
    pictures = [
        _plain(_levels(surface.colour)) if surface.texture is None else _opaque(surface.texture)
        for surface in appearance.surfaces
    ]
    corners = np.ascontiguousarray(appearance.uv.reshape(-1, 2), dtype=np.float64)
    of_face = appearance.surface_of_face.astype(np.int32)
    return _core.PaintedSurface(faces, pictures, of_face, corners, brightness), vertices


def _inside(appearance: Appearance | None) -> NDArray[np.bool_]:
    """Which surfaces are of the mouth's inside; none of another mesh than our own."""
    names = [surface.name for surface in appearance.surfaces] if appearance else []
    return (
        np.isin(names, [SURFACE_OF_PART[part] for part in INSIDE]) if names else np.zeros(1, bool)
    )


def _brightness(performance: Performance, template: FaceTemplate) -> NDArray[np.float64]:
    """V, the light that reaches each place: little of it the inside of the mouth."""
    neutral = performance.neutral_vertices
    light = np.ones(len(neutral))
    skin = template.part_vertices("skin")
    inside = np.setdiff1d(template.part_vertices(*INSIDE), skin)
    lips = neutral[[template.landmark(f"lip_{which}") for which in ("upper", "lower")], 2].min()
    depth = np.maximum(lips - neutral[inside, 2], 0.0)
    light[inside] *= IN_THE_SHADE + (1 - IN_THE_SHADE) * np.exp(-depth / INTO_THE_MOUTH)
    return light


def _template_of(performance: Performance) -> FaceTemplate | None:
    template = load_template()
    return template if np.array_equal(performance.faces, template.faces) else None


def _plain(colour: tuple[int, ...]) -> NDArray[np.uint8]:
    return np.full((16, 16, 4), (*colour, 255), dtype=np.uint8)


def _opaque(texture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    if texture.shape[2] == 4:
        return _coarser(texture)
    full = np.full((*texture.shape[:2], 1), 255, dtype=np.uint8)
    return np.ascontiguousarray(np.concatenate([texture, full], axis=2))


def _coarser(texture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Hairs thinner than a sample, as what they cover of a larger one."""
    rows, cols = texture.shape[0] // COARSER, texture.shape[1] // COARSER
    blocks = texture[: rows * COARSER, : cols * COARSER].reshape(rows, COARSER, cols, COARSER, 4)
    return np.ascontiguousarray(blocks.mean(axis=(1, 3)).astype(np.uint8))


def _levels(colour: tuple[float, float, float]) -> tuple[int, ...]:
    """A colour in linear light, 0 to 1, as sRGB's levels."""
    return tuple(int(level) for level in np.clip(255 * srgb(np.asarray(colour)) + 0.5, 0, 255))
