# SPDX-License-Identifier: GPL-3.0-or-later
"""Holes in the skin of a foreign head where a face has none."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.muscles.articulators import eye_frames
from mimetic.skin.mesh import SkinMesh

AROUND_EYE = 0.030  # m at the template's size, from its centre
AROUND_MOUTH = 0.040
AROUND_NOSE = 0.025  # nostrils


def hole_notes(skin: ForeignSkin, laid: SkinMesh, free: NDArray[np.bool_]) -> tuple[str, ...]:
    """A note, naming a face of the caller's, for each hole in free skin (N) that is not an eye's,
    the mouth's, a nostril's or the end of the mesh. laid: the template on this skin."""
    edges = np.concatenate([skin.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    face = np.tile(skin.face, 3)
    keys = np.sort(edges, axis=1) @ np.array([len(skin.vertices), 1])
    _, first, counts = np.unique(keys, return_index=True, return_counts=True)
    rim = first[counts == 1]
    notes = []
    loops = _loops(edges[rim], len(skin.vertices))
    lengths = [len(loop) for loop in loops]
    places = [(frame.centre, AROUND_EYE) for frame in eye_frames(laid)]
    inner = [skin.landmarks[f"lip_{lip}_inner"] for lip in ("upper", "lower")]
    places += [(np.mean(inner, axis=0), AROUND_MOUTH), (skin.landmarks["nose_tip"], AROUND_NOSE)]
    for number, loop in enumerate(loops):
        vertices = edges[rim[loop]].reshape(-1)
        middle = skin.vertices[vertices].mean(axis=0)
        belongs = any(np.linalg.norm(middle - place) < reach for place, reach in places)
        if belongs or number == int(np.argmax(lengths)) or not free[vertices].all():
            continue
        beside = int(face[rim[loop]].min())
        notes.append(f"there is a hole in the skin beside face {beside}: it was left open")
    return tuple(notes)


def _loops(edges: NDArray[np.int64], num_vertices: int) -> list[NDArray[np.int64]]:
    """Which of the edges (K x 2) hang together."""
    label = np.arange(num_vertices)
    while True:
        low = np.minimum(label[edges[:, 0]], label[edges[:, 1]])
        before = label.copy()
        for k in (0, 1):
            np.minimum.at(label, edges[:, k], low)
        if (label == before).all():
            break
    own = label[edges[:, 0]]
    return [np.flatnonzero(own == value) for value in np.unique(own)]
