# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks of MediaPipe's face mesh with refined lips and eyes; runs under scripts/face_mesh_env.

usage: python face_mesh_landmarks.py WIDTH HEIGHT OUT.npy < FRAMES

FRAMES: RGB, 8 bits, one after another, shown to it as video. Writes (N, 478, 2) pixels, (0, 0) the
centre of the top-left one; nan where no face is seen.
"""

from __future__ import annotations

import sys

import numpy as np
from mediapipe.python.solutions.face_mesh import FaceMesh

NUM_LANDMARKS = 478


def main(width: int, height: int, out: str) -> None:
    meshes = []
    with FaceMesh(max_num_faces=1, refine_landmarks=True) as mesh:
        while len(content := sys.stdin.buffer.read(width * height * 3)) == width * height * 3:
            frame = np.frombuffer(content, np.uint8).reshape(height, width, 3)
            faces = mesh.process(np.array(frame)).multi_face_landmarks
            points = np.full((NUM_LANDMARKS, 2), np.nan)
            if faces:
                points = np.array([(p.x, p.y) for p in faces[0].landmark]) * (width, height) - 0.5
            meshes.append(points)
    np.save(out, np.stack(meshes))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
