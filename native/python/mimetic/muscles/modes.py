# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes into which a skin is easily drawn: what moves much of it for little elastic energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic.muscles.anatomy import AttachedSkin
from mimetic.muscles.extras import vertex_areas
from mimetic.skin.mesh import SkinMesh

SWEEPS = 3  # of subspace iteration
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
    seen = np.zeros(len(mesh.vertices))
    seen[mesh.seen_from_front] = 1
    return vertex_areas(mesh) * seen


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
    random = np.random.default_rng(0)
    num_free = int(skin.free.sum())
    basis = random.normal(size=(3 * num_free, count + SPARE))
    for _ in range(SWEEPS):
        basis = np.linalg.qr(basis)[0]
        loads = weight * _on_limit(skin, basis)
        loads = np.ascontiguousarray(loads.transpose(1, 2, 0)).reshape(-1, basis.shape[1])
        basis = skin.model.solve(loads)
    seen = (np.sqrt(weight) * _on_limit(skin, basis)).reshape(basis.shape[1], -1)
    energy = basis.T @ skin.model.loads(loads)
    root = np.linalg.cholesky((energy + energy.T) / 2)
    inner = np.linalg.solve(root, np.linalg.solve(root, seen @ seen.T).T)
    compliance, vectors = np.linalg.eigh((inner + inner.T) / 2)
    chosen = np.linalg.solve(root.T, vectors[:, ::-1][:, :count])
    compliance = compliance[::-1][:count]
    response = np.zeros((count, len(skin.free), 3))
    response[:, skin.free] = (basis @ chosen).T.reshape(count, -1, 3)
    # A mode of unit energy moves the skin by the root of its compliance, root mean square
    lengths = UNIT / np.sqrt(compliance)
    return SkinModes(skin.spread(response) * lengths[:, None, None], compliance)


def _on_limit(skin: AttachedSkin, columns: NDArray[np.float64]) -> NDArray[np.float64]:
    """K x N x 3 of the refined skin from displacements of its free control vertices, columns."""
    moved = np.zeros((len(skin.free), 3))
    shapes = []
    for column in columns.T:
        moved[skin.free] = column.reshape(-1, 3)
        shapes.append(skin.mesh.refinement.positions(moved))
    return np.array(shapes)
