# SPDX-License-Identifier: GPL-3.0-or-later
"""Grey pictures of painted people, larger than the eigenspaces' ones, with their landmarks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic.fit.face_model import limit_positions
from mimetic.locate.landmarks import landmark_points
from mimetic.template.face_template import FaceTemplate

from evaluation.synthetic import scene
from evaluation.synthetic.motion import rotation
from evaluation.synthetic.stills.sitters import part_places, toward_light
from scripts.build.eigenspaces.people import DARK, Person, splatted

PX_PER_IPD = 48  # of the picture
SIDE = 264  # pixels of the picture
OVERSAMPLING = 2
COVERED = 0.004  # metres behind another point, for one not to be seen
LARGEST_YAW, LARGEST_PITCH = 42.0, 26.0  # degrees
PITCH_SPREAD, ROLL_SPREAD = 10.0, 4.0
DISTANCES = (0.33, 1.6)  # metres
AT_REST, MOST_UNITS = 0.35, 4  # part of the pictures; units moved in others
GAZE_REACH = 30.0  # degrees that a gaze unit turns an eye by, roughly


@dataclass(frozen=True)
class Shot:
    """One picture, pixels."""

    grey: np.ndarray  # SIDE x SIDE, uint8
    places: np.ndarray  # L x 2, the landmarks of `mimetic.locate.landmarks.landmark_points`
    pupils: np.ndarray  # 2 x 2, where they are seen, left first
    yaw: float  # degrees


class Sitter(Person):
    """One identity, drawn more finely."""

    def __init__(self, seed: int, template: FaceTemplate) -> None:
        super().__init__(seed, template)
        self._limit = limit_positions(template)
        self._weights_of_points = landmark_points(template)[1]
        self._gloss = self._rng.uniform(0, 0.35)

    def shot(self) -> Shot:
        """The person in another pose, expression, light and room."""
        rng, template = self._rng, self._template
        yaw, roll = rng.uniform(-1, 1) * LARGEST_YAW, rng.normal(0, ROLL_SPREAD)
        pitch = np.clip(rng.normal(0, PITCH_SPREAD), -LARGEST_PITCH, LARGEST_PITCH)
        moved = self._neutral + self._expression(yaw, pitch)
        turn = np.diag((1.0, -1, -1)) @ rotation(*np.radians([yaw, pitch, roll]))
        parts = part_places(template, self._neutral, moved)
        surface = self._on_limit(moved)
        middle = (parts[:2].mean(0) + parts[3]) / 2
        distance = np.exp(rng.uniform(*np.log(DISTANCES)))

        def project(points: np.ndarray, px: float, size: int) -> np.ndarray:
            turned_points = (points - middle) @ turn.T
            scale = px / 0.063 * distance / (distance + turned_points[:, 2:])
            return np.column_stack(
                [turned_points[:, :2] * scale + (size - 1) / 2, turned_points[:, 2]]
            )

        bright, facing = self._lit(surface, turn)
        shown = self._sampled(surface)[facing]
        levels = 255 * np.clip(bright[facing], 0, 1) ** (1 / 2.2)
        room = np.kron(rng.uniform(20, 235, (6, 6)), np.ones((SIDE // 6, SIDE // 6)))
        room = np.where(rng.random() < 0.5, room, rng.uniform(20, 235))
        # Fine points leave holes; coarse ones under them do not, and hide what is behind
        coarse, fine = (project(shown, PX_PER_IPD * n, SIDE * n) for n in (1, OVERSAMPLING))
        under = np.kron(splatted(room, coarse, levels), np.ones((OVERSAMPLING, OVERSAMPLING)))
        nearest = splatted(np.full(room.shape, 255.0), coarse, coarse[:, 2] + 1)  # all above 0
        column, row = np.clip(np.round(coarse[:, :2]), 0, SIDE - 1).astype(int).T
        in_front = coarse[:, 2] + 1 < nearest[row, column] + COVERED
        grey = splatted(under, fine[in_front], levels[in_front])
        grey = grey.reshape(SIDE, OVERSAMPLING, SIDE, OVERSAMPLING).mean((1, 3))
        points = np.vstack([surface[: template.num_skin_vertices], self._eyes()])
        return Shot(
            np.round(grey).astype(np.uint8),
            project(self._weights_of_points @ points, PX_PER_IPD, SIDE)[:, :2],
            project(parts[:2], PX_PER_IPD, SIDE)[:, :2],
            float(yaw),
        )

    def _eyes(self) -> np.ndarray:
        return np.asarray(self._template.eye_spheres(self._neutral)[0])

    def _on_limit(self, vertices: np.ndarray) -> np.ndarray:
        skin = self._template.num_skin_vertices
        return np.vstack([self._limit(vertices[:skin]), vertices[skin:]])

    def _lit(self, surface: np.ndarray, turn: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Reflected light of every point and whether it faces the camera."""
        rng = self._rng
        normals = self._sampled(scene.vertex_normals(surface, self._faces)) @ turn.T
        normals /= np.linalg.norm(normals, axis=1, keepdims=True) + 1e-12
        bright = self._albedo * rng.uniform(0.15, 0.6)
        for strength in (1.0, rng.uniform(0, 0.5)):  # a key and a fill
            light = toward_light(rng) * (1, -1, -1)  # camera: y down, z away
            bright = bright + strength * self._albedo * np.clip(normals @ light, 0, None)
            half = light - np.array([0, 0, 1])
            shine = np.clip(normals @ (half / np.linalg.norm(half)), 0, None) ** 18
            bright = bright + strength * self._gloss * shine * (self._albedo > min(DARK.values()))
        return bright * rng.uniform(0.7, 1.1), normals[:, 2] < 0.15

    def _expression(self, yaw: float, pitch: float) -> np.ndarray:
        """Displacement of every control vertex (V,3)."""
        rng, names = self._rng, self._template.unit_names
        values = np.zeros(len(names))
        movable = [n for n in names if not n.startswith("eyeLook") and n != "tongueOut"]
        if rng.random() > AT_REST:
            for name in rng.choice(movable, rng.integers(1, MOST_UNITS + 1), replace=False):
                strength = rng.uniform(0, 1)
                stem = name.removesuffix("Left").removesuffix("Right")
                both = [stem + "Left", stem + "Right"] if rng.random() < 0.75 else [name]
                for one in (name, *both):
                    if one in names:
                        values[names.index(one)] = strength
        # Eyes look ahead, at the camera, or anywhere
        across, up = [(0.0, 0.0), (-yaw, pitch), tuple(rng.normal(0, 12, 2))][rng.integers(3)]
        across, up = np.clip(np.array([across, up]) / GAZE_REACH, -1, 1)
        for side, inward in (("Left", -1), ("Right", 1)):
            values[names.index(f"eyeLookIn{side}")] = max(0.0, inward * across)
            values[names.index(f"eyeLookOut{side}")] = max(0.0, -inward * across)
            values[names.index(f"eyeLookUp{side}")] = max(0.0, up)
            values[names.index(f"eyeLookDown{side}")] = max(0.0, -up)
        return np.tensordot(values, self._template.unit_modes, axes=1)
