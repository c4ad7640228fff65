# SPDX-License-Identifier: GPL-3.0-or-later
"""A head's muscles and face units as they are seen from the front."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.muscles.extras import with_lip_shapes
from mimetic.skin.mesh import multiply
from mimetic.solve.tracking import UNMEASURED
from mimetic.template.face_template import FaceTemplate
from numpy.typing import NDArray

from evaluation.anatomy.expressiveness import Gauge, skin_units
from evaluation.synthetic.person import neutral_vertices, random_identity

FIRST_SEED = 4000  # nobody else has people of such seeds


@dataclass(frozen=True)
class Head:
    """Products of the fields of M values and U face units, metres^2.

    names, units: of the M and the U; num_muscles: of the M, the first ones; limits: M x 2; gram:
    M x M, beyond the head's own motion, mean over the measured skin as seen from the front;
    by_unit: M x U; overlaps: M x M, over the whole skin in space, as the core compares modes.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    num_muscles: int
    limits: NDArray[np.float64]
    gram: NDArray[np.float64]
    by_unit: NDArray[np.float64]
    overlaps: NDArray[np.float64]


def head_of(seed: int, template: FaceTemplate) -> Head:
    identity = random_identity(template.identity_names, template.identity_limits, seed)
    neutral = neutral_vertices(template, identity, seed)
    skin = attach_skin(neutral, template)
    anatomy = with_lip_shapes(modes_of(skin), skin)
    gauge = Gauge(skin)
    measured = (~template.in_region(*UNMEASURED))[: template.num_skin_vertices]
    share = multiply(gauge.mesh.stencils, measured.astype(np.float64)[:, None])[gauge.kept, 0]
    weight = np.repeat(np.sqrt(share.clip(0, 1)), 2)

    def fields(modes) -> NDArray[np.float64]:
        return np.stack([weight * gauge.field(mode, axes=2) for mode in modes], axis=1)

    own = np.linalg.qr(fields(_head_motions(neutral)))[0]
    units = skin_units(template)
    modes = np.concatenate([anatomy.muscle_modes, anatomy.articulator_modes])
    on_skin = modes[:, : template.num_skin_vertices].reshape(len(modes), -1)
    of_values = fields(modes)
    of_values -= own @ (own.T @ of_values)
    count = len(anatomy.muscle_names)
    return Head(
        (*anatomy.muscle_names, *anatomy.articulator_names),
        tuple(units),
        count,
        np.vstack([np.tile([0.0, 1.0], (count, 1)), anatomy.articulator_limits]),
        of_values.T @ of_values,
        of_values.T @ fields(units.values()),
        on_skin @ on_skin.T,
    )


def _head_motions(neutral: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """What a turned, moved or nearer head looks like, V x 3 each."""
    x, y, z = (neutral - neutral.mean(axis=0)).T
    none, one = np.zeros_like(x), np.ones_like(x)
    pairs = [(one, none), (none, one), (x, y), (-y, x), (z, none), (none, z)]
    return [np.stack([*pair, none], axis=1) for pair in pairs]
