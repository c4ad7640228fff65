# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person is given to wear in pictures of the face: glasses, hair over the brows."""

from __future__ import annotations

import numpy as np
from mimetic.performance.document import Performance
from mimetic.score.scores import project
from mimetic.score.truth import Truth
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

Frames = NDArray[np.uint8]  # N x H x W x 3
Wearer = Truth | Performance  # with a head in each frame
FRAME = np.array([28.0, 24.0, 26.0])
HAIR = np.array([52.0, 36.0, 24.0])
SQUARE = ((-1.0, -1.0, 0.0), (1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (-1.0, 1.0, 0.0))
RING, RIM = 0.023, 0.0026  # metres: radius of a lens, half the thickness of its frame
STRANDS, LONGEST, WIDTH = 90, 0.075, 0.0022  # of hair: how many, metres


def glasses(frames: Frames, wearer: Wearer, rng: np.random.Generator) -> Frames:
    """Thick rims a centimetre before the eyes, and a window's reflection in each lens."""
    return with_rims(frames, wearer, RIM, glare=True)


def with_rims(
    frames: Frames, wearer: Wearer, half_width: float, glare: bool = False, finer: int = 1
) -> Frames:
    """Round rims of a half width in metres before the eyes, and the bridge between them.

    glare: a window's reflection in each lens; finer: samples a pixel, along each axis.
    """
    template = load_template()
    centres, _ = template.eye_spheres(wearer.neutral_vertices)
    around = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    circle = np.stack([np.cos(around), 0.8 * np.sin(around), np.zeros(40)], 1)
    spoilt = frames.copy()
    for i, pose in enumerate(wearer.head_pose):
        for centre in centres:
            middle = centre + np.array((0, -0.004, 0.026))
            rings = [middle + radius * circle for radius in (RING + half_width, RING - half_width)]
            outer, inner = (_seen(ring, pose, wearer) for ring in rings)
            fill(spoilt[i], outer, FRAME, without=inner, finer=finer)
            if glare:
                window = middle + np.array((-0.006, 0.006, 0)) + 0.35 * RING * np.array(SQUARE)
                bright = np.full(3, 245.0)
                fill(spoilt[i], _seen(window, pose, wearer), bright, share=0.75, finer=finer)
        bridge = (
            centres.mean(0)
            + np.array((0, -0.002, 0.03))
            + np.array(SQUARE) * np.array((0.011, min(0.0022, half_width), 0))
        )
        fill(spoilt[i], _seen(bridge, pose, wearer), FRAME, finer=finer)
    return spoilt


def hair(frames: Frames, wearer: Wearer, rng: np.random.Generator) -> Frames:
    """Strands that hang from the forehead over the brows to the lids."""
    template, rest = load_template(), wearer.neutral_vertices
    brows = [rest[template.landmark(f"brow_outer.{side}")] for side in "LR"]
    shares = rng.uniform(-0.05, 1.05, STRANDS)
    lengths = rng.uniform(0.6, 1.0, STRANDS) * LONGEST
    leans = rng.normal(0, 0.006, STRANDS)
    spoilt = frames.copy()
    tops = np.array([brows[1] + share * (brows[0] - brows[1]) for share in shares])
    tops += (0, 0.058, 0.004)
    # The forehead bulges towards the camera between the brows' ends
    tops[:, 2] += 0.022 * np.sin(np.pi * np.clip(shares, 0, 1))
    for i, pose in enumerate(wearer.head_pose):
        for top, length, lean in zip(tops, lengths, leans, strict=True):
            end = top + np.array((lean, -length, 0.004))
            half = np.array((WIDTH, 0, 0))
            strand = [top - half, top + half, end + half / 3]
            fill(spoilt[i], _seen(np.array(strand), pose, wearer), HAIR, share=0.9)
    return spoilt


def _seen(points: NDArray, pose: NDArray, wearer: Wearer) -> NDArray[np.float64]:
    """Pixels (K,2) of points in the head frame."""
    return project(points, pose, wearer.intrinsics)


def fill(
    image: NDArray[np.uint8],
    polygon: NDArray,
    colour: NDArray,
    share: float = 1.0,
    without: NDArray | None = None,
    finer: int = 1,
) -> None:
    """Paints the polygon (K,2) into the picture, but not what lies in `without`.

    colour: (3,) or (H,W,3), grey levels; finer: samples a pixel, along each axis.
    """
    from matplotlib.path import Path as Outline

    height, width = image.shape[:2]
    low = np.clip(np.floor(polygon.min(0)).astype(int), 0, (width - 1, height - 1))
    high = np.clip(np.ceil(polygon.max(0)).astype(int) + 1, 1, (width, height))
    size = high - low
    across, down = (
        start + (np.arange(count * finer) + 0.5) / finer - 0.5
        for start, count in zip(low, size, strict=True)
    )
    x, y = np.meshgrid(across, down)
    places = np.column_stack([x.ravel(), y.ravel()])
    inside = Outline(polygon).contains_points(places)
    if without is not None:
        inside &= ~Outline(without).contains_points(places)
    region = slice(low[1], high[1]), slice(low[0], high[0])
    part, paint = image[region], np.broadcast_to(colour, image.shape)[region]
    samples = inside.reshape(size[1], finer, size[0], finer)
    cover = share * samples.mean((1, 3))[..., None]
    part[:] = np.round(part + cover * (paint - part))
