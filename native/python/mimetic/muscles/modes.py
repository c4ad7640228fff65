# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes into which a skin is easily drawn: what moves much of it for little elastic energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import AttachedSkin
from mimetic.skin.mesh import SkinMesh

SPARE = 12  # columns carried along, so that the last ones asked for converge too
UNIT = 1e-3  # metres, root mean square over the counted skin at the coefficient 1


@dataclass(frozen=True)
class SkinModes:
    """K modes of the whole head, K x V x 3, metres at the coefficient 1; compliance: K, falling.

    Coefficients are uncorrelated, with variances in proportion to the compliances, where skin is
    drawn at random with a probability that falls with its energy.
    """

    modes: NDArray[np.float64]
    compliance: NDArray[np.float64]


def visible_area(mesh: SkinMesh) -> NDArray[np.float64]:
    """N: square metres of each refined vertex that can be seen from the front, else 0."""
    area = np.zeros(len(mesh.vertices))
    area[mesh.seen_from_front] = 1
    return mesh.surface.areas * area


def low_energy_modes(
    skin: AttachedSkin,
    count: int,
    weight: NDArray[np.float64] | None = None,
    axes: tuple[float, float, float] = (1, 1, 1),
) -> SkinModes:
    """The `count` modes with the largest ratio of weighted square displacement to energy.

    weight: N, of each refined vertex; by default `visible_area`; axes: how much displacement along
    x, y and z counts: (1, 1, 0) for what a frontal picture shows. By subspace iteration.
    """
    weight = visible_area(skin.mesh) if weight is None else weight
    weight = weight[:, None] / weight.sum() * np.array(axes)
    num_free = int(skin.free.sum())
    start = np.random.default_rng(0).normal(size=(3 * num_free, count + SPARE))
    modes, compliance = _core.low_energy_modes(skin, weight, start, count, UNIT)
    return SkinModes(skin.spread(modes), compliance)
