# SPDX-License-Identifier: GPL-3.0-or-later
"""Small grey pictures of painted people, drawn as points: quick, and another renderer than the one
whose pictures the result is scored on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic.score.luminance import GREY
from mimetic.template.face_template import FaceTemplate

from evaluation.synthetic import scene
from evaluation.synthetic.motion import rotation
from evaluation.synthetic.person import neutral_vertices
from evaluation.synthetic.recipes import Recipe
from evaluation.synthetic.stills.sitters import expression_of, part_places, toward_light
from evaluation.synthetic.texture import eye_albedo

PX_PER_IPD = 40  # of the picture
SIDE = 200  # pixels of the picture
SAMPLES_PER_SIDE = 4  # of a control face: 1.2 mm apart, pixels are 1.6 mm
DRAWN_PARTS = ("skin", "eye.L", "eye.R", "mouth_cavity", "teeth_upper", "teeth_lower")
DARK = {"mouth_cavity": 0.05, "teeth_upper": 0.5, "teeth_lower": 0.45}
LARGEST = {"yaw": 36.0, "pitch": 14.0, "roll": 6.0}  # degrees
LARGEST_BEHIND = {"yaw": 50.0, "pitch": 20.0, "roll": 10.0}  # degrees


@dataclass(frozen=True)
class Picture:
    grey: np.ndarray  # SIDE x SIDE, uint8
    places: np.ndarray  # pupil.L, pupil.R, nose, mouth x 2, pixels
    yaw: float  # degrees; a head seen from behind has 180 within LARGEST_BEHIND


class Person:
    """One identity with painted skin, ready to be drawn many times."""

    def __init__(self, seed: int, template: FaceTemplate) -> None:
        self._rng = np.random.default_rng([seed, 71])
        self._template = template
        recipe = Recipe("still", "still", seed, 1)
        self._neutral = neutral_vertices(template, scene.identity_of(recipe, template), seed)
        steps = (np.arange(SAMPLES_PER_SIDE) + 0.5) / SAMPLES_PER_SIDE
        s, t = (grid.ravel() for grid in np.meshgrid(steps, steps))
        self._weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
        chosen = [template.part_faces(name) for name in DRAWN_PARTS]
        self._faces = template.faces[np.concatenate(chosen)]
        self._albedo = np.concatenate(
            [
                self._paint(name, recipe, faces)
                for name, faces in zip(DRAWN_PARTS, chosen, strict=True)
            ]
        )

    def picture(self, behind: bool = False) -> Picture:
        """The person in another pose, expression, light and room; or the back of the head."""
        rng = self._rng
        moved = self._neutral + expression_of(rng, self._template)
        largest = LARGEST_BEHIND if behind else LARGEST
        yaw, pitch, roll = rng.uniform(-1, 1, 3) * list(largest.values())
        yaw += 180 * behind
        turn = np.diag((1.0, -1, -1)) @ rotation(*np.radians([yaw, pitch, roll]))
        parts = part_places(self._template, self._neutral, moved)
        middle = (parts[:2].mean(0) + parts[3]) / 2
        distance = rng.uniform(0.6, 1.5)

        def project(points: np.ndarray) -> np.ndarray:
            turned_points = (points - middle) @ turn.T
            scale = PX_PER_IPD / 0.063 * distance / (distance + turned_points[:, 2:])
            return np.column_stack(
                [turned_points[:, :2] * scale + (SIDE - 1) / 2, turned_points[:, 2]]
            )

        light = toward_light(rng) * (1, -1, -1)  # camera: y down, z away
        normals = self._sampled(scene.vertex_normals(moved, self._faces)) @ turn.T
        normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
        lit = np.clip(normals @ light, 0, None)
        bright = self._albedo * (rng.uniform(0.25, 0.6) + lit)
        pixels = project(self._sampled(moved))
        facing = normals[:, 2] < 0.15
        grey = splatted(self._room(), pixels[facing], 255 * bright[facing] ** (1 / 2.2))
        return Picture(grey.astype(np.uint8), project(parts)[:, :2], float(yaw))

    def _paint(self, part: str, recipe: Recipe, faces: np.ndarray) -> np.ndarray:
        """Grey reflectance of a part's points, linear light."""
        points = np.einsum("fcd,cs->fsd", self._neutral[self._template.faces[faces]], self._weights)
        points = points.reshape(-1, 3)
        if part in DARK:
            return np.full(len(points), DARK[part])
        if part == "skin":
            color = scene.painter(recipe, self._template, self._neutral).albedo(points)
        else:
            centers, radius = self._template.eye_spheres(self._neutral)
            color = eye_albedo(points, centers["LR".index(part[-1])], radius, recipe.seed)
        return color @ GREY

    def _sampled(self, values: np.ndarray) -> np.ndarray:
        return np.einsum("fcd,cs->fsd", values[self._faces], self._weights).reshape(-1, 3)

    def _room(self) -> np.ndarray:
        """Blocks of any grey, softened."""
        cells = self._rng.uniform(20, 235, (5, 5))
        blocks = np.kron(cells, np.ones((SIDE // 5, SIDE // 5)))
        return 0.7 * blocks + 0.3 * self._rng.uniform(20, 235)


def splatted(picture: np.ndarray, seen: np.ndarray, grey: np.ndarray) -> np.ndarray:
    """The picture under points (x, y, depth), the nearest on top."""
    order = np.argsort(-seen[:, 2])
    corner = np.floor(seen[order, :2]).astype(int)
    # Each point covers the four pixels round it: no holes between points
    around = corner[:, None] + np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    x, y = around.reshape(-1, 2).T
    inside = (x >= 0) & (y >= 0) & (x < picture.shape[1]) & (y < picture.shape[0])
    drawn = picture.copy()
    drawn[y[inside], x[inside]] = np.repeat(grey[order], 4)[inside]
    return np.clip(drawn, 0, 255)
