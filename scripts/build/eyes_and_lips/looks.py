# SPDX-License-Identifier: GPL-3.0-or-later
"""Skin, lips, lashes, beards and eyes of drawn people, more varied than where clips are scored."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mimetic.template.face_template import FaceTemplate

from evaluation.synthetic import scene
from evaluation.synthetic.noise import ValueNoise, smoothstep
from evaluation.synthetic.recipes import Recipe
from evaluation.synthetic.texture import Look, SkinPainter, eye_albedo, positions_by_texel

from .people import iris_angle

TEXEL_STEP = 2
PAINTED_RIM = 0.38  # radians from the axis, of `eye_albedo`
# sRGB; darker and paler people than TONES has
TONES = np.array([[243, 214, 196], [226, 180, 150], [186, 136, 104], [136, 92, 66], [84, 56, 42]])
HAIRS = np.array([[30, 22, 20], [70, 48, 32], [120, 84, 50], [170, 140, 96], [150, 146, 140]])
IRISES = np.array([[58, 36, 22], [96, 62, 34], [110, 130, 150], [92, 104, 66], [120, 112, 84]])


class VariedPainter(SkinPainter):
    """A person with make-up, lashes, stubble or a beard of their own."""

    def __init__(self, look: Look, landmarks: dict[str, np.ndarray], seed: int) -> None:
        super().__init__(look, landmarks)
        rng = np.random.default_rng([seed, 301])
        self._lip_shade = _lip_shade(rng)
        self._margin_shade = rng.uniform(0.12, 0.75), rng.uniform(0.2, 0.95)
        self._shadow = np.clip(rng.normal(0.75, 0.2, 3), 0.2, 1.1)
        self._shadow_share = rng.choice([0.0, 0.0, rng.uniform(0.2, 0.8)])
        self._beard = rng.choice([0.0, 0.0, 0.0, rng.uniform(0.3, 0.95)])
        self._beard_noise = ValueNoise(seed + 17)

    def albedo(self, points: np.ndarray) -> np.ndarray:
        """Linear-light reflectance (N,3) at neutral positions (N,3) of the skin."""
        tone, hair = self._look.tone, self._look.hair
        color = self._spots(self._bare_skin(points), points)
        color = _mixed(color, 0.25 * hair + 0.5 * tone, self._stubble(points))
        color = _mixed(color, color * self._shadow, self._shadow_share * self._lid_skin(points))
        lips = tone * self._lip_shade * (1 + 0.12 * self._lip_creases(points))[:, None]
        red = self._lips(points)
        color = _mixed(color, hair * 0.9 + 0.05, self._bearded(points) * (1 - red))
        color = _mixed(color, lips, red)
        shade, share = self._margin_shade
        color = _mixed(color, shade * tone, share * self._lid_margins(points))
        strands = hair * (1 + 0.45 * self._strands(points))[:, None]
        color = _mixed(color, strands, np.maximum(self._brows(points), self._scalp(points)))
        return np.clip(color, 0, 1) ** 2.2

    def _lid_skin(self, points: np.ndarray) -> np.ndarray:
        """Between an eye and its brow."""
        cover = np.zeros(len(points))
        for side in "LR":
            lid, brow = self._at[f"lid_upper.{side}"], self._at[f"brow_middle.{side}"]
            reach = np.linalg.norm(brow - lid)
            away = np.linalg.norm((points - lid) / (2.0, 1.0, 2.0), axis=1)
            above = smoothstep(-0.003, 0.001, points[:, 1] - lid[1] + 0.004)
            cover = np.maximum(cover, above * (1 - smoothstep(0.3 * reach, 0.9 * reach, away)))
        return cover

    def _bearded(self, points: np.ndarray) -> np.ndarray:
        """A beard and moustache: hairs round the mouth and on the chin."""
        nose, mouth = self._at["nose_base"], self._at["lip_upper"]
        below = smoothstep(nose[1] - 0.002, nose[1] - 0.008, points[:, 1])
        front = smoothstep(0.0, 0.03, points[:, 2])
        fibres = self._beard_noise.octaves(points, ((0.0012, 0.004, 0.004), (0.006, 0.006, 0.006)))
        thick = 1 - 0.5 * smoothstep(0.0, 0.03, mouth[1] - points[:, 1])
        return self._beard * below * front * np.clip(thick * (0.8 + 0.5 * fibres), 0, 1)


def textures(recipe: Recipe, template: FaceTemplate, neutral: np.ndarray) -> dict[str, np.ndarray]:
    """Textures by name (S,S,3) float32, linear light; row 0 is v = 0."""
    rng = np.random.default_rng([recipe.seed, 302])
    blend = rng.uniform(0, len(TONES) - 1.001)
    low = int(blend)
    tone = (TONES[low] + (blend - low) * (TONES[low + 1] - TONES[low])) / 255
    look = replace(
        Look.random(recipe.seed),
        tone=tone * rng.uniform(0.93, 1.07, 3),
        hair=HAIRS[rng.integers(len(HAIRS))] / 255,
        stubble=float(rng.choice([0.0, 0.0, 0.2, 0.5])),
    )
    places = zip(template.landmark_names, template.landmark_vertices, strict=True)
    landmarks = {str(name): neutral[vertex] for name, vertex in places}
    painter = VariedPainter(look, landmarks, recipe.seed)
    centers, radius = template.eye_spheres(neutral)
    sclera = rng.uniform(0.75, 1.1) * np.array([1, rng.uniform(0.9, 1), rng.uniform(0.84, 1)])
    iris = IRISES[rng.integers(len(IRISES))] / IRISES.mean() * rng.uniform(0.5, 1.6)
    made = {}
    for name in ("skin", "eye.L", "eye.R"):
        chosen = template.part_faces(name)
        uv = scene._stretched(template.uv[chosen])
        points = positions_by_texel(neutral, template.faces[chosen], uv)
        points = points[::TEXEL_STEP, ::TEXEL_STEP]
        covered = ~np.isnan(points[..., 0])
        image = np.zeros((*covered.shape, 3), np.float32)
        if name == "skin":
            image[covered] = painter.albedo(points[covered])
        else:
            center = centers["LR".index(name[-1])]
            off = _nearer_axis(points[covered] - center, PAINTED_RIM / iris_angle(recipe))
            albedo = eye_albedo(center + off, center, radius, recipe.seed)
            angle = np.arccos(np.clip(off[:, 2] / np.linalg.norm(off, axis=1), -1, 1))
            colored = smoothstep(0.40, 0.36, angle)[:, None]
            image[covered] = np.clip(albedo * (colored * iris + (1 - colored) * sclera), 0, 1)
        made[name] = image
    return made


def _lip_shade(rng: np.random.Generator) -> np.ndarray:
    """Of the skin's tone: bare lips, hardly seen ones, or painted ones."""
    kind = rng.random()
    if kind < 0.6:
        return np.array([0.88, 0.66, 0.65]) * rng.uniform(0.85, 1.1)
    if kind < 0.8:
        return np.array([0.95, 0.84, 0.82]) * rng.uniform(0.92, 1.06)
    return np.array([rng.uniform(0.6, 1.0), rng.uniform(0.15, 0.5), rng.uniform(0.2, 0.55)])


def _nearer_axis(offsets: np.ndarray, share: float) -> np.ndarray:
    """Offsets (N,3) from an eyeball's middle, their angles from its axis times `share`."""
    length = np.linalg.norm(offsets, axis=1)
    angle = share * np.arccos(np.clip(offsets[:, 2] / length, -1, 1))
    aside = offsets[:, :2] / np.maximum(np.linalg.norm(offsets[:, :2], axis=1), 1e-9)[:, None]
    return length[:, None] * np.column_stack([np.sin(angle)[:, None] * aside, np.cos(angle)])


def _mixed(base: np.ndarray, top: np.ndarray, share: np.ndarray) -> np.ndarray:
    return base + np.clip(share, 0, 1)[:, None] * (top - base)
