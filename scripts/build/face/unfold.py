# SPDX-License-Identifier: GPL-3.0-or-later
"""Texture coordinates: the neck beside the head, eyes and lashes to fit any picture of them."""

from __future__ import annotations

import itertools

import numpy as np

from .head import PART_NAMES, Cut, sphere_center
from .regions import HEAD_ISLAND_TOP
from .topology import boundary_loops, components, rings

NECK_LOW, NECK_HIGH = np.array([0.645, 0.09]), np.array([0.99, 0.14])


def unfold(vertices: np.ndarray, cut: Cut) -> np.ndarray:
    """The cut's texture coordinates (F,4,2) with those of neck, eyes and lashes replaced.

    Neck: a strip under the head's island, so that the face has most of a square picture.
    Eyes: azimuthal equidistant, the optical axis at (0.5, 0.5), 180 degrees 0.5 away from it.
    Lashes: u from the inner to the outer corner of the eye, v from root to tip, both 0 to 1.
    """
    uv = cut.uv.copy()
    neck = (cut.part == PART_NAMES.index("skin")) & (uv[..., 1].min(1) > HEAD_ISLAND_TOP)
    low, high = uv[neck].min((0, 1)), uv[neck].max((0, 1))
    uv[neck] = NECK_LOW + (uv[neck] - low) / (high - low) * (NECK_HIGH - NECK_LOW)
    for side in "LR":
        center, _ = sphere_center(vertices[cut.part_vertices(f"eye.{side}")])
        on_eye = cut.part == PART_NAMES.index(f"eye.{side}")
        uv[on_eye] = _azimuthal(vertices[cut.faces[on_eye]] - center)
        on_lashes = np.flatnonzero(cut.part == PART_NAMES.index(f"lashes.{side}"))
        cards = components(cut.faces[on_lashes])
        for card in np.unique(cards):
            own = on_lashes[cards == card]
            uv[own] = _along_card(vertices, cut.faces[own], center)
    return uv


def _azimuthal(away: np.ndarray) -> np.ndarray:
    across = np.linalg.norm(away[..., :2], axis=-1, keepdims=True)
    angle = np.arctan2(across, away[..., 2:])
    return 0.5 + away[..., :2] / across * angle / (2 * np.pi)


def _along_card(vertices: np.ndarray, faces: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Grid coordinates (F,4,2) of a rectangular patch of quads that stands on the lid's margin."""
    loop = boundary_loops(faces)[0]
    corners = np.flatnonzero(np.bincount(faces.ravel())[loop] == 1)
    loop = np.append(np.roll(loop, -corners[0]), loop[corners[0]])
    corners = np.append(corners - corners[0], len(loop) - 1)
    sides = [loop[a : b + 1] for a, b in itertools.pairwise(corners)]
    if len(sides) != 4:
        raise ValueError(f"a patch of lashes has {len(sides)} corners, not 4")
    sides.sort(key=len)
    inner = min(sides[:2], key=lambda side: np.abs(vertices[side, 0]).mean())
    root = min(sides[2:], key=lambda side: np.linalg.norm(vertices[side] - eye, axis=1).mean())
    steps = [rings(faces, seed, len(vertices)).astype(float) for seed in (inner, root)]
    return np.stack([step[faces] / step.max() for step in steps], axis=-1)
