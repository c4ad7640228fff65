# SPDX-License-Identifier: GPL-3.0-or-later
"""People who are not the template: identity, some shape that no identity mode has, scale."""

from __future__ import annotations

import numpy as np
from mimetic.template.face_template import FaceTemplate

INTERPUPILLARY_DISTANCE = 0.063
IDENTITY_SPREAD = 0.18
BUMPS = 24
BUMP_HEIGHT = 0.0009
BUMP_RADIUS = 0.022


def random_identity(names: list[str], limits: np.ndarray, seed: int) -> np.ndarray:
    """Coefficient of every identity mode (I,), drawn about the template within its limits (I,2)."""
    rng = np.random.default_rng([seed, 1])
    half_range = (limits[:, 1] - limits[:, 0]) / 2
    drawn = rng.normal(0, IDENTITY_SPREAD, len(names)) * half_range
    return np.clip(drawn, limits[:, 0], limits[:, 1])


def neutral_vertices(template: FaceTemplate, identity: np.ndarray, seed: int) -> np.ndarray:
    """The person's control mesh at rest (V,3), metres, head frame, 63 mm between the pupils.

    identity (I,), a coefficient of every identity mode.
    """
    vertices = template.vertices + np.tensordot(identity, template.identity_modes, axes=1)
    vertices = vertices + _bumps(vertices, template, seed)
    eyes, _ = template.eye_spheres(vertices)
    ears = [vertices[template.landmark(f"tragus.{side}")] for side in "LR"]
    scale = INTERPUPILLARY_DISTANCE / np.linalg.norm(eyes[0] - eyes[1])
    return (vertices - np.mean(ears, axis=0)) * scale


def _bumps(vertices: np.ndarray, template: FaceTemplate, seed: int) -> np.ndarray:
    """Smooth asymmetric displacement of the skin alone: real heads are in no one's basis."""
    rng = np.random.default_rng([seed, 2])
    skin = vertices[: template.num_skin_vertices]
    moved = np.zeros_like(vertices)
    for center in skin[rng.choice(len(skin), BUMPS)]:
        squared = ((skin - center) ** 2).sum(1)
        weight = np.exp(-squared / (2 * BUMP_RADIUS**2))
        moved[: len(skin)] += weight[:, None] * rng.normal(0, BUMP_HEIGHT, 3)
    return moved
