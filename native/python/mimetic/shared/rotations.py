# SPDX-License-Identifier: GPL-3.0-or-later
"""Rotations in the forms that curves hold: quaternions, Euler angles, rotation vectors.

All take and give N at once; neighbours in time stay on one side, so that curves have no jumps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput

Floats = NDArray[np.float64]
ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
SMALL = 1e-8  # radians: below it a sine is its angle to the last digit


def quaternions(rotations: Floats) -> Floats:
    """N x 4 unit quaternions (w x y z) of N x 3 x 3 rotations, each nearest to the one before.

    Bar-Itzhack 2000: the eigenvector of the largest eigenvalue; it has no special cases.
    """
    r = rotations
    matrix = np.empty((len(r), 4, 4))
    matrix[:, 0, 0] = np.trace(r, axis1=1, axis2=2)
    axis = np.stack(
        [r[:, 2, 1] - r[:, 1, 2], r[:, 0, 2] - r[:, 2, 0], r[:, 1, 0] - r[:, 0, 1]], axis=1
    )
    matrix[:, 0, 1:] = matrix[:, 1:, 0] = axis
    matrix[:, 1:, 1:] = r + r.transpose(0, 2, 1)
    matrix[:, 1:, 1:] -= matrix[:, 0, 0, None, None] * np.eye(3)
    found = np.linalg.eigh(matrix)[1][:, :, -1]
    found[0] *= np.copysign(1.0, found[0, 0])
    turns = np.einsum("ij,ij->i", found[1:], found[:-1])
    found[1:] *= np.cumprod(np.copysign(1.0, turns))[:, None]
    return found


def rotation_vectors(rotations: Floats) -> Floats:
    """N x 3 axes times angles (radians), each the one nearest to that before it.

    Whoever turns on past half a turn gets vectors longer than pi, not a jump.
    """
    found = quaternions(rotations)
    sines = np.linalg.norm(found[:, 1:], axis=1)
    angles = 2 * np.arctan2(sines, found[:, 0])
    axes = found[:, 1:] / np.maximum(sines, SMALL)[:, None]
    vectors = np.where((sines > SMALL)[:, None], angles[:, None] * axes, 2 * found[:, 1:])
    for i in range(1, len(vectors)):  # a quaternion's two sides are angles a full turn apart
        turns = np.round((vectors[i - 1] @ axes[i] - vectors[i] @ axes[i]) / (2 * np.pi))
        vectors[i] += 2 * np.pi * turns * axes[i]
    return vectors


def from_rotation_vectors(vectors: Floats) -> Floats:
    """... x 3 x 3 rotations of axes times angles (radians): Rodrigues."""
    angles = np.linalg.norm(vectors, axis=-1)[..., None, None]
    k = skew(vectors)
    near = angles < 1e-4
    safe = np.where(near, 1.0, angles)
    first = np.where(near, 1 - angles**2 / 6, np.sin(safe) / safe)
    second = np.where(near, 0.5 - angles**2 / 24, (1 - np.cos(safe)) / safe**2)
    return np.eye(3) + first * k + second * (k @ k)


def skew(vectors: Floats) -> Floats:
    """... x 3 x 3 matrices that take the cross product with ... x 3 vectors."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def inverse_left_jacobians(vectors: Floats) -> Floats:
    """N x 3 x 3: how a rotation vector changes with a small turn put before its rotation.

    log(exp(d) exp(r)) = r + J d (Sola et al. 2018, eq. 146). Singular at a full turn.
    """
    angles = np.linalg.norm(vectors, axis=1)[:, None, None]
    k = skew(vectors)
    near = angles < 1e-3
    safe = np.where(near, 1.0, angles)
    second = 1 / safe**2 - (1 + np.cos(safe)) / (2 * safe * np.sin(np.where(near, 1.0, safe)))
    return np.eye(3) - 0.5 * k + np.where(near, 1 / 12, second) * (k @ k)


def mean_rotation(rotations: Floats) -> Floats:
    """The rotation (3 x 3) nearest to N x 3 x 3 in least squares of their entries."""
    u, _, vt = np.linalg.svd(rotations.sum(axis=0))
    return u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt


def powers(rotations: Floats, share: float) -> Floats:
    """N x 3 x 3 rotations about the same axes by a share of the angle."""
    return from_rotation_vectors(share * rotation_vectors(rotations))


def euler_angles(rotations: Floats, order: str, first: Floats | None = None) -> Floats:
    """N x 3 angles about x, y and z (radians) of N x 3 x 3 rotations.

    order: one of ORDERS, the first letter turns first, as in Blender: 'XYZ' is Rz Ry Rx.
    first: 3 angles that the first row shall be near to; each later row is near to the one before.
    """
    if order not in ORDERS:
        raise InvalidInput(f"order of rotation {order!r}; there are {', '.join(ORDERS)}")
    i, j, k = ("XYZ".index(letter) for letter in order)
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    r = rotations
    angles = np.empty((len(r), 3))
    flat = np.hypot(r[:, i, i], r[:, j, i])
    angles[:, i] = np.arctan2(sign * r[:, k, j], r[:, k, k])
    angles[:, j] = np.arctan2(-sign * r[:, k, i], flat)
    angles[:, k] = np.arctan2(sign * r[:, j, i], r[:, i, i])
    other = np.empty_like(angles)
    other[:, [i, k]] = angles[:, [i, k]] + np.pi
    other[:, j] = np.pi - angles[:, j]
    before = np.zeros(3) if first is None else np.asarray(first, dtype=np.float64)
    for row in range(len(r)):
        choices = np.stack([angles[row], other[row]])
        choices -= 2 * np.pi * np.round((choices - before) / (2 * np.pi))
        before = choices[np.argmin(np.abs(choices - before).sum(axis=1))]
        angles[row] = before
    return angles
