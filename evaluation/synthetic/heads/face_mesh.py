# SPDX-License-Identifier: GPL-3.0-or-later
"""Head poses by MediaPipe's face mesh and OpenCV's solvePnP; runs under scripts/face_mesh_env.

usage: python face_mesh.py FRAMES.npy INTRINSICS.npy REST_FRAMES OUT.npz

FRAMES (N,H,W,3) uint8 RGB. Writes head_pose (N,4,4, camera from head; nan without a face) and
seconds (N,) of the mesh and the pose together. The rigid model is the mesh itself, its mean over
the first REST_FRAMES frames: nearer to this person than a general face is.
"""

from __future__ import annotations

import sys
import time

import cv2
import numpy as np
from mediapipe.python.solutions.face_mesh import FaceMesh

PUPIL_DISTANCE = 0.063
EYE_CORNERS = ((33, 133), (263, 362))  # outer and inner, of the mesh's right and left
HEAD_AXES = np.diag((1.0, -1.0, -1.0))
WARM_UP = 5  # frames


def in_pixels(face, width: int, height: int) -> np.ndarray:
    """Landmarks (468,3): pixels, depth in the same unit."""
    points = np.array([(p.x, p.y, p.z) for p in face.landmark])
    return points * (width, height, width) - (0.5, 0.5, 0)


def rigid_model(meshes: list[np.ndarray]) -> np.ndarray:
    """Points (468,3) in metres, head axes (y up, z out of the face), about their middle."""
    mean = np.mean(meshes, axis=0)
    eyes = [mean[list(corners)].mean(0) for corners in EYE_CORNERS]
    scale = PUPIL_DISTANCE / np.linalg.norm(eyes[0] - eyes[1])
    return (mean - mean.mean(0)) @ HEAD_AXES * scale


def main(frames_path: str, intrinsics_path: str, rest: str, out: str) -> None:
    frames = np.load(frames_path, mmap_mode="r", allow_pickle=False)
    intrinsics = np.load(intrinsics_path, allow_pickle=False)
    height, width = frames.shape[1:3]
    with FaceMesh(max_num_faces=1) as first_look:
        faces = [first_look.process(np.array(f)).multi_face_landmarks for f in frames[: int(rest)]]
    model = rigid_model([in_pixels(face[0], width, height) for face in faces if face])
    poses = np.full((len(frames), 4, 4), np.nan)
    seconds = np.zeros(len(frames))
    turn = shift = None
    with FaceMesh(max_num_faces=1) as mesh:
        for _ in range(WARM_UP):
            mesh.process(np.array(frames[0]))
        for i, frame in enumerate(frames):
            frame = np.array(frame)
            start = time.perf_counter()
            faces = mesh.process(frame).multi_face_landmarks
            if faces:
                pixels = in_pixels(faces[0], width, height)[:, :2].copy()
                if turn is None:
                    _, turn, shift = cv2.solvePnP(
                        model, pixels, intrinsics, None, flags=cv2.SOLVEPNP_SQPNP
                    )
                _, turn, shift = cv2.solvePnP(model, pixels, intrinsics, None, turn, shift, True)
                poses[i] = np.eye(4)
                poses[i, :3, :3], poses[i, :3, 3] = cv2.Rodrigues(turn)[0], shift[:, 0]
            seconds[i] = time.perf_counter() - start
    np.savez(out, head_pose=poses, seconds=seconds)


if __name__ == "__main__":
    main(*sys.argv[1:])
