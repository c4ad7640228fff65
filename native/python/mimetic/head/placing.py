# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses by a simple model of the head, put where the person's own skin has them.

Flow hardly tells a flat head that turns far from a deep one that turns less, and no ellipsoid has
the relief of a face: it overturns, much by the same share wherever it looks the same way. Where the
reference textures are is known on both models; between them the difference is interpolated by
a Gaussian process over the head's direction (Rasmussen and Williams 2006, chapter 2). How
far the differences are trusted is what makes them most likely (their section 5.4.1): those of
expressions have no order.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mimetic import _core
from mimetic.shared.rotations import Floats, from_rotation_vectors, rotation_vectors

SHARE = 0.15  # of a turn: s.d. of what it is off by
OWN = 0.03  # rad: s.d. beyond that
REACH = 0.5  # rad of direction over which that is one
DOUBTS = (0.005, 0.01, 0.02, 0.04, 0.08, 0.16)  # rad: s.d. of a reference texture's difference
LEVER = 0.1  # metres that count as a radian


def placed_poses(poses: Floats, views: Sequence[_core.PlacedView]) -> Floats:
    """poses: camera from head (N,4,4) by the model. returns: N x 4 x 4, on the skin."""
    on_model = np.array([view.on_model for view in views])
    on_skin = np.array([view.on_skin for view in views])
    turns = rotation_vectors(on_skin[:, :3, :3] @ on_model[:, :3, :3].transpose(0, 2, 1))
    shifts = (on_skin[:, :3, 3] - on_model[:, :3, 3]) / LEVER
    first = on_model[0, :3, :3].T
    known = rotation_vectors(on_model[:, :3, :3] @ first)
    wanted = rotation_vectors(poses[:, :3, :3] @ first)
    spread = _covariance(known, known) + _doubt(known, turns) ** 2 * np.eye(len(known))
    offsets = _covariance(wanted, known) @ np.linalg.solve(spread, np.hstack([turns, shifts]))
    result = poses.copy()
    result[:, :3, :3] = from_rotation_vectors(offsets[:, :3]) @ poses[:, :3, :3]
    result[:, :3, 3] += LEVER * offsets[:, 3:]
    return result


def _doubt(directions: Floats, turns: Floats) -> float:
    """The one of DOUBTS under which the turns (N,3) at the directions (N,3) are most likely."""
    likelihoods = []
    for doubt in DOUBTS:
        spread = _covariance(directions, directions) + doubt**2 * np.eye(len(turns))
        weighted = np.sum(turns * np.linalg.solve(spread, turns))
        likelihoods.append(-0.5 * weighted - 1.5 * np.linalg.slogdet(spread)[1])
    return DOUBTS[int(np.argmax(likelihoods))]


def _covariance(a: Floats, b: Floats) -> Floats:
    """N x M: of the offsets at directions (N,3) and (M,3), rotation vectors from the first one."""
    apart = ((a[:, None] - b[None]) ** 2).sum(axis=-1)
    return SHARE**2 * a @ b.T + OWN**2 * np.exp(-0.5 * apart / REACH**2)
