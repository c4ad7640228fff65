# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows pixels of the first frame on MediaPipe's face mesh; runs under scripts/face_mesh_env.

usage: python face_mesh_points.py FRAMES.npy PIXELS.npy OUT.npz

FRAMES (N,H,W,3) uint8 RGB, PIXELS (K,2) of the first frame. Writes tracks (N,K,2) and points
(N,K,3), metres, in the head frame that lays the mesh on its own first frame (a similarity: the mesh
knows no distance); nothing without a face in the first frame. Pixels beside the mesh move as its
nearest landmark does and have no points.
"""

from __future__ import annotations

import sys

import numpy as np
from matplotlib.tri import Triangulation
from mediapipe.python.solutions.face_mesh import FaceMesh

PUPIL_DISTANCE = 0.063
EYE_CORNERS = ((33, 133), (263, 362))  # outer and inner, of the mesh's right and left
HEAD_AXES = np.diag((1.0, -1.0, -1.0))


def meshes_of(frames: np.ndarray) -> np.ndarray | None:
    """Landmarks (N,468,3), pixels, depth in the same unit; None without a face at first."""
    height, width = frames.shape[1:3]
    found: list[np.ndarray] = []
    with FaceMesh(max_num_faces=1) as mesh:
        for _ in range(5):  # it settles
            mesh.process(np.array(frames[0]))
        for frame in frames:
            faces = mesh.process(np.array(frame)).multi_face_landmarks
            if faces:
                points = np.array([(p.x, p.y, p.z) for p in faces[0].landmark])
                found.append(points * (width, height, width) - (0.5, 0.5, 0))
            elif found:
                found.append(found[-1])
            else:
                return None
    return np.stack(found)


def laid_on(mesh: np.ndarray, target: np.ndarray) -> np.ndarray:
    """The mesh (468,3) moved, turned and scaled onto the target (Umeyama 1991)."""
    a, b = mesh - mesh.mean(0), target - target.mean(0)
    u, s, vt = np.linalg.svd(b.T @ a)
    flip = np.array([1, 1, np.linalg.det(u @ vt)])
    turn, scale = u @ np.diag(flip) @ vt, (s * flip).sum() / (a**2).sum()
    return scale * a @ turn.T + target.mean(0)


def main(frames_path: str, pixels_path: str, out: str) -> None:
    frames = np.load(frames_path, mmap_mode="r", allow_pickle=False)
    pixels = np.load(pixels_path, allow_pickle=False)
    meshes = meshes_of(frames)
    if meshes is None:
        return
    first = meshes[0]
    net = Triangulation(first[:, 0], first[:, 1])
    triangle = net.get_trifinder()(pixels[:, 0], pixels[:, 1])
    corners = net.triangles[np.maximum(triangle, 0)]
    a, b, c = (first[corners[:, i], :2] for i in range(3))
    sides = np.stack([b - a, c - a], axis=2)
    inner = np.linalg.solve(sides, (pixels - a)[..., None])[..., 0]
    weights = np.column_stack([1 - inner.sum(1), inner])
    nearest = np.linalg.norm(pixels[:, None] - first[None, :, :2], axis=2).argmin(1)
    inside = triangle >= 0
    tracks = np.einsum("kc,nkcd->nkd", weights, meshes[:, corners, :2])
    beside = pixels + meshes[:, nearest, :2] - first[nearest, :2]
    tracks = np.where(inside[:, None], tracks, beside)
    eyes = [first[list(corner)].mean(0) for corner in EYE_CORNERS]
    metres = PUPIL_DISTANCE / np.linalg.norm(eyes[0] - eyes[1])
    laid = np.stack([laid_on(mesh, first) for mesh in meshes]) @ HEAD_AXES * metres
    points = np.einsum("kc,nkcd->nkd", weights, laid[:, corners])
    points[:, ~inside] = np.nan
    np.savez(out, tracks=tracks, points=points)


if __name__ == "__main__":
    main(*sys.argv[1:])
