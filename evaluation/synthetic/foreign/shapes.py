# SPDX-License-Identifier: GPL-3.0-or-later
"""Expression shapes of this family: a thin sheet drawn by a few points, no skin and no muscles.

Each shape says where some vertices of the mask go, in millimetres; the rest follow so that the
sheet bends least, cut at lips and lids. Softness and strength differ from person to person.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .head_mesh import LANDMARKS, LIPS, HeadMesh

# Of the left side: vertex of the mask -> millimetres outward, up, forward; the right mirrors it.
MIRROR = {291: 61, 425: 205, 374: 145, 426: 206, 267: 37, 358: 129, 351: 122, 285: 55, 347: 118}
MIRROR |= {282: 52, 276: 46, 337: 108, 386: 159, 287: 57, 273: 43, 269: 39, 405: 181, 334: 105}
SIDES: dict[str, dict[int, tuple[float, float, float]]] = {
    "smile": {291: (6, 7, -3), 425: (2, 4, 1), 426: (4, 5, -1), 374: (0, 1, 0), 347: (0, 2, 0.5)},
    "disgust": {
        **{358: (1, 4, 0), 351: (0, 3, 0.5), 267: (0, 4, 1), 426: (1, 4, 0), 347: (0, 2, 0.5)},
        **{285: (-1.5, -3, 0.5), 282: (0, -2, 0)},
    },
    "surprise": {
        **{285: (0, 6, -0.5), 282: (0, 7, -1), 276: (0, 5, -1), 337: (0, 4, -0.5)},
        386: (0, 1, 0),
    },
    "anger": {
        **{285: (-2.5, -5, 0.5), 282: (-1, -4, 0.5), 276: (0, -1, 0), 337: (0, -1.5, 0)},
        **{269: (0, -1.5, -1), 405: (0, 2, -1), 374: (0, 1, 0)},
    },
    "frown": {291: (1, -6, -1), 287: (1, -6, -1), 273: (1, -5, 0)},
    "speech": {291: (-4, 0, 3), 267: (-1, 1, 3), 405: (-1, -1, 3)},
}
MIDDLE: dict[str, dict[int, tuple[float, float, float]]] = {
    "smile": {0: (0, 1, -1.5), 17: (0, 0.5, -1.5)},
    "disgust": {0: (0, 4, 1), 6: (0, -1, 0)},
    "anger": {0: (0, -1.5, -1), 17: (0, 2, -1), 8: (0, -3, 0.5)},
    "frown": {17: (0, 1.5, 1), 199: (0, 2, 1)},
    "speech": {0: (0, 1, 3), 17: (0, -1, 3)},
}
JAW_DEGREES = {"surprise": 9.0, "speech": 6.0}
NAMES = tuple(SIDES)
LAZINESS = 0.05  # pull to rest, of a vertex
HELD = (10, 338, 109, 297, 67, 168, 1, 4, 454, 234, 447, 227)  # stay where they are


def shapes(head: HeadMesh, seed: int) -> NDArray[np.float64]:
    """Displacements (E,V,3) of every expression of NAMES at full strength."""
    rng = np.random.default_rng([seed, 73])
    softness = 10 * rng.uniform(0.7, 1.6)
    moved = []
    for name in NAMES:
        strength = rng.uniform(0.85, 1.1)
        goals = {vertex: np.zeros(3) for vertex in HELD}
        goals |= {k: np.array(d) * strength for k, d in MIDDLE.get(name, {}).items()}
        skew = 1 + 0.12 * rng.normal()
        for vertex, (out, up, front) in SIDES[name].items():
            goals[vertex] = strength * np.array([out, up, front])
            goals[MIRROR[vertex]] = strength * skew * np.array([-out, up, front])
        millimetres = {k: d / 1000 for k, d in goals.items()}
        if name in JAW_DEGREES:
            _add_jaw(head, strength * JAW_DEGREES[name], millimetres)
        moved.append(_sheet(head, millimetres, softness))
    return np.stack(moved)


def _add_jaw(head: HeadMesh, degrees: float, goals: dict[int, NDArray]) -> None:
    """The chin and the lower lip turn about the joints of the jaw."""
    mask = head.vertices[: head.num_mask]
    axis = np.array([0, 0.0, mask[LANDMARKS["tragus.L"], 2] + 0.012])
    turn = np.radians(degrees)
    cosine, sine = np.cos(turn), np.sin(turn)
    about_x = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
    turned = (mask - axis) @ about_x.T + axis - mask
    lower_lip = mask[LANDMARKS["lip_lower"], 1]
    chin = np.flatnonzero((mask[:, 1] < lower_lip - 0.006) & (mask[:, 2] > axis[2] + 0.05))
    for vertex in (*chin, *LIPS[3:8], LANDMARKS["lip_lower"]):
        goals[int(vertex)] = goals.get(int(vertex), np.zeros(3)) + turned[vertex]


def _sheet(head: HeadMesh, goals: dict[int, NDArray], softness: float) -> NDArray[np.float64]:
    """The displacement (V,3) of a sheet that bends least; eyeballs stay."""
    num = len(head.vertices)
    edges = np.concatenate([head.triangles[:, [0, 1]], head.triangles[:, [1, 2]]])
    edges = np.concatenate([edges, head.triangles[:, [2, 0]]])
    joined = np.zeros((num, num))
    joined[edges[:, 0], edges[:, 1]] = joined[edges[:, 1], edges[:, 0]] = 1
    apart = joined / np.maximum(1, joined.sum(1, keepdims=True)) - np.eye(num)
    held = np.array(list(goals))
    firm = np.zeros(num)
    firm[held] = 300.0
    wanted = np.zeros((num, 3))
    wanted[held] = np.stack([goals[k] for k in held.tolist()])
    bending = softness**2 * apart.T @ apart
    moved = np.linalg.solve(bending + np.diag(firm + LAZINESS), firm[:, None] * wanted)
    is_eyeball = head.part >= 4
    moved[np.unique(head.triangles[is_eyeball])] = 0
    return moved
