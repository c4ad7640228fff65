# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a head's limit surface, by point splatting into a depth buffer, with numpy alone: no
window, no graphics driver."""

from __future__ import annotations

import numpy as np
from mimetic import _core

WIDTH = 0.19  # m of the head in a picture
TALLEST = 1.18  # height over width
COLORS = {
    "skin": (0.80, 0.70, 0.63),
    "mouth_cavity": (0.55, 0.27, 0.25),
    "eye_socket": (0.74, 0.55, 0.50),
    "teeth": (0.93, 0.91, 0.86),
    "tongue": (0.75, 0.38, 0.36),
    "eye": (0.93, 0.93, 0.96),
}
IRIS, PUPIL = (0.30, 0.36, 0.40), (0.06, 0.06, 0.07)
IRIS_EDGE, PUPIL_EDGE = np.cos(np.radians(22)), np.cos(np.radians(9))  # off the eye's axis
TINT = np.array([0.80, 0.12, 0.08])
FULL_TINT = 0.012  # m of displacement drawn in the full tint


def color_of(part: str) -> tuple[float, float, float]:
    """Lashes have none: they are cards that need a picture of hairs, and would hide the lids."""
    return next((color for name, color in COLORS.items() if part.startswith(name)), (np.nan,) * 3)


class Painter:
    """Draws the head's limit surface from one side; the mesh is prepared once."""

    def __init__(self, template, size: int, yaw: float, focus: str | None = None):
        self.template = template
        self.shape = (round(size * TALLEST), size)
        self.mesh = _core.SubdividedMesh(
            np.ascontiguousarray(template.faces, np.int32), len(template.vertices), 2
        )
        palette = np.array([color_of(str(name)) for name in template.part_names])
        self.color = palette[template.part[self.mesh.parent_face]]
        self.drawn = np.isfinite(self.color[:, 0])
        cos, sin = np.cos(np.radians(yaw)), np.sin(np.radians(yaw))
        self.view_from_head = np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
        aside = 0.035 * sin  # the face, not the ear, belongs in the middle
        middle = np.array([aside * cos, 0.01, 0.05 + aside * sin])
        self.scale = size / WIDTH
        if focus:
            at = list(template.landmark_names).index(focus)
            middle = np.asarray(template.vertices)[template.landmark_vertices[at]]
            self.scale *= 2.5
        self.middle = middle @ self.view_from_head.T
        self.toward_iris = self._toward_iris()

    def _toward_iris(self) -> np.ndarray:
        """Cosine of each refined vertex off its eye's axis, at rest; -1 where there is no eye."""
        rest = self.mesh.positions(np.ascontiguousarray(self.template.vertices))
        part = np.asarray(self.template.part_names)[self.template.part[self.mesh.parent_face]]
        cosine = np.full((len(rest), 1), -1.0)
        for side, centre in zip("LR", self.template.eye_centers, strict=True):
            eye = np.unique(self.mesh.faces[part == f"eye.{side}"])
            arm = rest[eye] - centre
            cosine[eye, 0] = arm[:, 2] / np.linalg.norm(arm, axis=1)
        return cosine

    def paint(self, vertices: np.ndarray, displacement: np.ndarray, tint: bool = True):
        """Picture H x W x 3 float of the displaced head (V x 3, m), tinted by its displacement."""
        shape = np.ascontiguousarray(vertices + displacement)
        points = self.mesh.positions(shape) @ self.view_from_head.T - self.middle
        normals = self.mesh.normals(shape) @ self.view_from_head.T
        motion = np.linalg.norm(
            self.mesh.positions(np.ascontiguousarray(displacement)), axis=1, keepdims=True
        )
        values = np.hstack([points, normals, motion * tint, self.toward_iris])
        height, width = self.shape
        nearest = np.full(height * width, -np.inf)
        image = np.ones((height * width, 3))
        for place, color in self._fragments(values):
            column = np.floor(place[:, 0] * self.scale + width / 2).astype(int)
            row = np.floor(height / 2 - place[:, 1] * self.scale).astype(int)
            inside = (column >= 0) & (column < width) & (row >= 0) & (row < height)
            inside &= place[:, 5] > -0.2  # backs of faces
            pixel = (row * width + column)[inside]
            order = np.argsort(place[inside, 2], kind="stable")
            last = np.full(height * width, -1)
            last[pixel[order]] = order
            hit = np.nonzero(last >= 0)[0]
            depth = place[inside, 2][last[hit]]
            front = depth > nearest[hit]
            nearest[hit[front]] = depth[front]
            image[hit[front]] = self._shade(
                place[inside][last[hit[front]]], color[inside][last[hit[front]]]
            )
        return image.reshape(height, width, 3)

    def _fragments(self, values: np.ndarray):
        """Points on all faces, dense enough to fill pixels, in groups of faces of like size."""
        corners = values[self.mesh.faces]  # F x 4 x 8
        flat = corners[:, :, :2] * self.scale
        sides = np.linalg.norm(flat - np.roll(flat, 1, axis=1), axis=2).max(axis=1)
        count = np.clip(np.exp2(np.ceil(np.log2(1.6 * sides + 1))), 2, 64).astype(int)
        toward = corners[:, :, 5].max(axis=1) > -0.2
        for n in np.unique(count):
            is_chosen = (count == n) & toward & self.drawn
            t = (np.arange(n) + 0.5) / n
            s, t = (a.ravel() for a in np.meshgrid(t, t))
            weights = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
            fragments = np.einsum("kp,fkc->fpc", weights, corners[is_chosen])
            color = np.repeat(self.color[is_chosen], n * n, axis=0)
            yield fragments.reshape(-1, 8), color

    def _shade(self, values: np.ndarray, color: np.ndarray) -> np.ndarray:
        color = np.where(values[:, 7:8] > IRIS_EDGE, IRIS, color)
        color = np.where(values[:, 7:8] > PUPIL_EDGE, PUPIL, color)
        normal = values[:, 3:6] / np.maximum(np.linalg.norm(values[:, 3:6], axis=1), 1e-9)[:, None]
        key = np.clip(normal @ (np.array([-0.45, 0.55, 0.70])), 0, 1)
        fill = np.clip(normal @ (np.array([0.75, 0.10, 0.45])), 0, 1)
        light = (0.16 + 0.75 * key + 0.22 * fill)[:, None]
        share = 0.65 * np.clip(values[:, 6:7] / FULL_TINT, 0, 1)
        return np.clip(((1 - share) * color + share * TINT) * light, 0, 1) ** (1 / 1.6)
