# SPDX-License-Identifier: GPL-3.0-or-later
"""Plain pictures for the head's texture coordinates: skin with lips and brows, eyes, lashes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.template.face_template import FaceTemplate

SKIN = np.array([0.80, 0.595, 0.50])  # sRGB, as all colours here
SCLERA = np.array([0.90, 0.88, 0.86])
LIPS = np.array([0.70, 0.40, 0.37])
BLOOD = np.array([0.83, 0.52, 0.44])  # cheeks, nose, ears
STUBBLE = np.array([0.62, 0.50, 0.44])
BROW = np.array([0.24, 0.16, 0.12])
VERMILION_RINGS = 7  # rings of faces between the lips' contact and the vermilion border
PUPIL, IRIS, LIMBUS = 7.0, 19.5, 21.0  # degrees from the optical axis
BROWN = np.array([0.36, 0.25, 0.15])  # of an iris
LASHES_PER_LID = 44
LASH = np.array([0.07, 0.05, 0.04])


def fill_square(template: FaceTemplate) -> NDArray[np.float64]:
    """Texture coordinates (F x 4 x 2) with the skin filling the square; eyes and lashes have
    squares of their own.
    """
    uv = np.asarray(template.uv, np.float64).copy()
    visible = template.part_faces("skin")
    low, high = uv[visible].min((0, 1)), uv[visible].max((0, 1))
    own = template.part_faces("eye.L", "eye.R", "lashes.L", "lashes.R")
    others = np.setdiff1d(np.arange(len(uv)), own)
    uv[others] = 0.01 + 0.98 * (uv[others] - low) / (high - low)
    return uv


def paint_skin(
    template: FaceTemplate, uv: NDArray[np.float64], size: int, seed: int = 1
) -> NDArray[np.float64]:
    """Albedo (size x size x 3, sRGB 0 to 1, first row on top)."""
    random = np.random.default_rng(seed)
    texels = _unwrap(template, uv, _vertex_masks(template), size)
    blood, lips, shorn, brows = (texels[..., [i]] for i in range(4))
    fine, coarse = _noise(random, size, 2), _noise(random, size, 24)
    albedo = SKIN + 0.35 * blood * (BLOOD - SKIN)
    albedo = albedo * (1 + 0.035 * coarse + 0.045 * fine)
    albedo += 0.55 * shorn * np.clip(0.7 + fine, 0, 1.6) * (STUBBLE - SKIN)
    albedo += lips * (LIPS * (1 + 0.05 * fine) - albedo)
    hair = np.clip(0.92 * brows * (1 + 0.45 * _hair(random, size)), 0, 1)
    albedo += hair * (BROW - albedo)
    return np.clip(albedo, 0, 1)


def paint_eye(size: int, iris_colour: NDArray[np.float64] = BROWN) -> NDArray[np.float64]:
    """Pupil, iris and sclera (size x size x 3, sRGB) in the eyes' azimuthal coordinates."""
    degrees, turn = eye_angles(size)
    rays = 0.5 + 0.25 * np.sin(23 * turn) + 0.25 * np.sin(37 * turn + 1)
    ring = np.clip((degrees - PUPIL) / (IRIS - PUPIL), 0, 1)
    iris = iris_colour * (0.75 + 0.5 * rays * (1 - ring))[..., None]
    iris *= (1 - 0.55 * np.clip(ring - 0.75, 0, 1) / 0.25)[..., None]
    redness = np.clip((degrees - 30) / 50, 0, 1)[..., None]
    sclera = SCLERA - redness * np.array([0.02, 0.16, 0.16])
    eye = sclera + _step(LIMBUS, IRIS, degrees)[..., None] * (iris - sclera)
    return eye * (1 - 0.97 * _step(PUPIL + 0.8, PUPIL - 0.8, degrees)[..., None])


def eye_angles(size: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Of each texel of an eye (size x size each): degrees from its optical axis, and in which
    direction, in radians."""
    axis = (np.arange(size) + 0.5) / size - 0.5
    x, y = np.meshgrid(axis, -axis)
    return 360.0 * np.hypot(x, y), np.arctan2(y, x)


def paint_lashes(width: int, height: int, seed: int = 1) -> NDArray[np.float64]:
    """Hairs over nothing (height x width x 4, sRGB and alpha), roots in the bottom row."""
    random = np.random.default_rng(seed)
    alpha = np.zeros((height, width))
    columns = np.arange(width)
    roots = (np.arange(LASHES_PER_LID) + random.uniform(0.1, 0.9, LASHES_PER_LID)) / LASHES_PER_LID
    lean = (roots - 0.35) * 0.06 + random.normal(scale=0.008, size=LASHES_PER_LID)
    length = random.uniform(0.55, 0.95, LASHES_PER_LID)
    for row in range(height):
        up = 1 - (row + 0.5) / height
        growth = np.clip(1 - up / length, 0, 1)
        center = (roots + lean * up**1.5) * width
        half = (0.02 + 0.08 * growth) * width / LASHES_PER_LID
        cover = np.clip(half + 0.5 - np.abs(columns[:, None] - center), 0, 1) * (growth > 0)
        alpha[row] = cover.max(1)
    return np.concatenate([np.broadcast_to(LASH, (height, width, 3)), alpha[..., None]], axis=2)


def _vertex_masks(template: FaceTemplate) -> NDArray[np.float64]:
    """V x 4 in 0 to 1: blood under the skin, vermilion, shorn hair, brows."""
    n = template.num_skin_vertices
    masks = np.zeros((len(template.vertices), 4))
    masks[:n, 0] = template.in_region("cheek", "nose", "ear", "chin")
    masks[:n, 2] = template.in_region("scalp")
    skin = template.faces[template.part_faces("skin")]
    for _ in range(3):  # soften over a few quads
        for column in (0, 2):
            masks[:, column] = _spread(masks[:, column], skin)
    masks[:, 1] = np.clip(1.4 - 0.8 * _rings_past_lips(template), 0, 1)
    masks[:n, 3] = _brows(template)
    return masks


def _spread(values: NDArray[np.float64], faces: NDArray) -> NDArray[np.float64]:
    """Each vertex takes the mean of the faces round it."""
    count = np.bincount(faces.ravel(), minlength=len(values))
    total = np.bincount(faces.ravel(), np.repeat(values[faces].mean(1), 4), minlength=len(values))
    return np.divide(total, count, out=values.copy(), where=count > 0)


def _rings_past_lips(template: FaceTemplate) -> NDArray[np.float64]:
    """0 inside the vermilion border, from 1 on it the number of rings outward (V)."""
    faces = template.faces[template.part_faces("skin")]
    is_reached = np.zeros(len(template.vertices), bool)
    is_reached[np.intersect1d(faces, template.faces[template.part_faces("mouth_cavity")])] = True
    ring = np.where(is_reached, 0, 99)
    for step in range(1, VERMILION_RINGS + 6):
        is_reached[faces[is_reached[faces].any(1)]] = True
        ring[is_reached & (ring == 99)] = step
    return np.maximum(ring - VERMILION_RINGS + 1, 0)


def _brows(template: FaceTemplate) -> NDArray[np.float64]:
    """1 on the brows' line, falling to 0 at their edge and below 0 beyond (S)."""
    points = template.vertices[: template.num_skin_vertices]
    names = ("brow_inner.L", "brow_middle.L", "brow_outer.L")
    line = template.vertices[[template.landmark(name) for name in names]]
    arch = np.polyfit(line[:, 0], line[:, 1], 2)
    x = np.abs(points[:, 0])
    along = (x - line[0, 0] + 0.004) / (line[2, 0] - line[0, 0] + 0.006)
    half_height = 0.0048 * np.clip(1.1 - 0.65 * along, 0.2, 1)
    over = (points[:, 1] - np.polyval(arch, x)) / half_height
    ends = np.clip(np.minimum(along * 8, (1 - along) * 6) + 0.3, -5, 1)
    in_front = points[:, 2] > line[2, 2] - 0.03
    return np.where(in_front, np.clip(1.25 - np.abs(over), -5, 1) + np.minimum(ends - 1, 0), -5)


def _unwrap(
    template: FaceTemplate, uv: NDArray[np.float64], masks: NDArray[np.float64], size: int
) -> NDArray[np.float64]:
    """Vertex values as a picture (size x size x K), 0 where no skin is."""
    skin = template.part_faces("skin")
    corners = np.asarray(uv[skin], np.float64).reshape(-1, 2)
    picture = _core.unwrap_values(masks, template.faces[skin], corners, size)
    return np.clip(picture.reshape(size, size, -1), 0, 1)


def _noise(random: np.random.Generator, size: int, grain: int) -> NDArray[np.float64]:
    """Smooth noise (size x size x 1), zero mean, about -1 to 1, with bumps of `grain` texels."""
    nodes = random.normal(size=(size // grain + 2, size // grain + 2)) * 0.5
    place = np.arange(size) / grain
    index, part = place.astype(int), place % 1
    part = part * part * (3 - 2 * part)
    rows = nodes[index] * (1 - part)[:, None] + nodes[index + 1] * part[:, None]
    return (rows[:, index] * (1 - part) + rows[:, index + 1] * part)[..., None]


def _hair(random: np.random.Generator, size: int) -> NDArray[np.float64]:
    """Noise drawn out along the brows (the texture's rows run across the face), about -1 to 1."""
    noise = random.normal(size=(size, size))
    strands = np.zeros_like(noise)
    for k in range(8):
        strands += np.roll(noise, (k, k // 3), axis=(0, 1))
    return strands[..., None] / 5


def _step(above: float, below: float, value: NDArray) -> NDArray[np.float64]:
    """1 under `below`, 0 over `above`, smooth between."""
    t = np.clip((above - value) / (above - below), 0, 1)
    return t * t * (3 - 2 * t)
