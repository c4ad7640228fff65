# SPDX-License-Identifier: GPL-3.0-or-later
"""What follows a face in a clip: ours and others, in one form."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.performance.document import Performance
from mimetic.score.peers import dis_tracks
from mimetic.score.prediction import follow
from numpy.typing import NDArray

from evaluation.runs.face_mesh import mesh_tracks
from evaluation.runs.vertex_flow import SeenVertices

OURS, MUSCLES = "mimetic", "muscles alone"
LOOP = "paper's loop"
CHAINED, DIRECT = "DIS chained", "DIS direct"
VERTICES, MESH = "flow on vertices", "face mesh"


@dataclass(frozen=True)
class Motion:
    """What a method says of K points that it was shown in the first of N frames."""

    tracks: NDArray[np.float64]  # N x K x 2, pixels
    points: NDArray[np.float64] | None = None  # N x K x 3, metres, its own head frame; nan: unknown
    performance: Performance | None = None


def of_performance(performance: Performance, start: NDArray[np.float64]) -> Motion:
    prediction = follow(performance, start)
    return Motion(prediction.tracks, prediction.points, performance)


def peers(
    performance: Performance,
    images: list[NDArray[np.uint8]],
    start: NDArray[np.float64],
    mesh_python: Path | None,
) -> dict[str, Motion]:
    """Methods without muscles by name. performance: only its fitted neutral surface is used."""
    vertices = SeenVertices.under(performance, start)
    flow = dis_tracks(images, np.concatenate([start, vertices.pixels]))
    motions = {
        CHAINED: Motion(flow["chained"][:, : len(start)]),
        DIRECT: Motion(flow["direct"][:, : len(start)]),
    }
    motions[VERTICES] = Motion(
        motions[DIRECT].tracks, vertices.points(flow["direct"][:, len(start) :])
    )
    if mesh_python is not None:
        mesh = mesh_tracks(images, start, mesh_python)
        if mesh is not None:
            motions[MESH] = Motion(*mesh)
    return motions
