# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks of MediaPipe's face mesh with refined lips and eyes; runs under scripts/face_mesh_env.

usage: python face_mesh_landmarks.py OUT.npy WIDTH HEIGHT < FRAMES
       python face_mesh_landmarks.py OUT.npy --stills WIDTH HEIGHT [WIDTH HEIGHT ...] < PICTURES

FRAMES: RGB, 8 bits, one after another, shown to it as video. PICTURES: each of its own size and
seen by itself. Writes (N, 478, 2) pixels, (0, 0) the centre of the top-left one; nan where no face
is seen.
"""

from __future__ import annotations

import itertools
import sys

import numpy as np
from mediapipe.python.solutions.face_mesh import FaceMesh

NUM_LANDMARKS = 478


def main(out: str, *arguments: str) -> None:
    is_still = arguments[0] == "--stills"
    numbers = [int(word) for word in arguments[is_still:]]
    sizes = zip(numbers[::2], numbers[1::2], strict=True)
    meshes = []
    with FaceMesh(is_still, max_num_faces=1, refine_landmarks=True) as mesh:
        for width, height in sizes if is_still else itertools.repeat(next(sizes)):
            content = sys.stdin.buffer.read(width * height * 3)
            if len(content) < width * height * 3:
                break
            picture = np.frombuffer(content, np.uint8).reshape(height, width, 3)
            faces = mesh.process(np.array(picture)).multi_face_landmarks
            points = np.full((NUM_LANDMARKS, 2), np.nan)
            if faces:
                points = np.array([(p.x, p.y) for p in faces[0].landmark]) * (width, height) - 0.5
            meshes.append(points)
    np.save(out, np.stack(meshes))


if __name__ == "__main__":
    main(*sys.argv[1:])
