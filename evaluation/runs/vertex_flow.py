# SPDX-License-Identifier: GPL-3.0-or-later
"""A face followed without skin or muscles: every vertex goes where the flow takes it.

The person's fitted surface gives the depth: the head's pose is what explains the flow of all
vertices best as rigid motion, and each vertex lies on its pixel's ray as deep as that pose has it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic import InvalidInput
from mimetic._core import from_rotation_vectors
from mimetic.performance.document import Performance
from mimetic.performance.places import RefinedSurface, places_under
from numpy.typing import NDArray

from evaluation.runs.projection import project_points

ITERATIONS = 10
ROBUST_PX = 0.7  # residuals larger than this count less and less


@dataclass(frozen=True)
class SeenVertices:
    """The fitted surface's P vertices about K pixels of the first frame.

    Of the performance only its surface and its pose of the first frame are used.
    """

    pixels: NDArray[np.float64]  # P x 2, in the first frame
    neutral: NDArray[np.float64]  # P x 3, metres, head frame
    corners: NDArray[np.int64]  # O x 3, of the triangle under each pixel on the face
    weights: NDArray[np.float64]  # O x 3
    on_face: NDArray[np.bool_]  # K, O of them
    camera_from_head: NDArray[np.float64]  # 4 x 4
    intrinsics: NDArray[np.float64]  # 3 x 3

    @classmethod
    def under(cls, performance: Performance, start: NDArray[np.float64]) -> SeenVertices:
        surface = RefinedSurface(performance)
        at_start = surface.in_camera(0)
        under = places_under(surface, start)
        if under is None:
            raise InvalidInput("no skin of the performance faces the camera in the first frame")
        on_face = under.on_face
        vertices, places = np.unique(
            surface.triangles[under.triangle[on_face]], return_inverse=True
        )
        pose = performance.head_pose[0]
        return cls(
            performance.project(at_start[vertices]),
            (at_start[vertices] - pose[:3, 3]) @ pose[:3, :3],
            places.reshape(-1, 3),
            under.weights[on_face],
            on_face,
            pose,
            performance.intrinsics,
        )

    def points(self, tracks: NDArray[np.float64]) -> NDArray[np.float64]:
        """Points (N,K,3) in the head frame from the vertices' tracks (N,P,2); nan off the face."""
        points = np.full((len(tracks), len(self.on_face), 3), np.nan)
        back = np.linalg.inv(self.intrinsics).T
        pose = self.camera_from_head
        for i, track in enumerate(tracks):
            pose = _rigid_pose(self.neutral, track, self.intrinsics, pose)
            depth = (self.neutral @ pose[:3, :3].T + pose[:3, 3])[:, 2:]
            rays = np.column_stack([track, np.ones(len(track))]) @ back
            vertices = (depth * rays - pose[:3, 3]) @ pose[:3, :3]
            corners = vertices[self.corners]
            points[i, self.on_face] = np.einsum("kc,kcx->kx", self.weights, corners)
        return points


def _rigid_pose(
    neutral: NDArray, pixels: NDArray, intrinsics: NDArray, start: NDArray
) -> NDArray[np.float64]:
    """The pose (4,4) that takes points (P,3) nearest to pixels (P,2), robustly."""
    pose = start.copy()
    for _ in range(ITERATIONS):
        places, _, slopes = project_points(neutral, pose, intrinsics)
        off = pixels - places
        weight = 1 / (1 + (off**2).sum(1) / ROBUST_PX**2)
        normal = np.einsum("pij,p,pik->jk", slopes, weight, slopes)
        step = np.linalg.solve(normal, np.einsum("pij,p,pi->j", slopes, weight, off))
        pose[:3, :3] = from_rotation_vectors(step[None, :3])[0] @ pose[:3, :3]
        pose[:3, 3] += step[3:]
        if np.abs(step).max() < 1e-6:
            break
    return pose
