# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a person's muscles go: beyond what is assumed where a whole clip shows it.

A clip is solved with the assumed strengths. Muscles that stand at activation 1 in it may go further
(`SmootherOptions.muscle_headroom`). How far they go, and a deviation of that measurement further,
is taken for this person's full contraction, their extent: activations are stated relative to it,
modes go that much further. All priors stay those of the assumed strengths, so that no work moves
between muscles because one of them was raised.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.face_fit import FaceFit
from mimetic.muscles.anatomy import Anatomy
from mimetic.muscles.extras import articulator_limits
from mimetic.performance.document import Performance
from mimetic.performance.evidence import evidence_factors

# Times the assumed displacement: two standard deviations above the mean, 30 % of it each, as people
# differ in the largest they can do: smile 9.3 mm (s.d. 2.8), brows raised 10.6 (2.5), lids 9.1
# (2.2), forehead wrinkled 7.6 (3.3) ["Objective computerized evaluation of normal patterns of
# facial muscles contraction", Braz. J. Otorhinolaryngol.: 12 people, markers].
HEADROOM = 1.6


def smoother_options(fps: float) -> _core.SmootherOptions:
    """Of a whole clip, of so many frames a second."""
    options = _core.SmootherOptions()
    options.frame_rate = fps
    options.muscle_headroom = HEADROOM
    return options


def refining_options(fps: float) -> _core.SmootherOptions:
    """Of frames that are solved again, whose bounds are the extents.

    The capture knew none before it had solved all within 1: what is at work is told as it did.
    """
    options = _core.SmootherOptions()
    options.frame_rate = fps
    options.first_muscle_bound = 1.0
    return options


def with_extent(
    fit: FaceFit,
    names: tuple[str, ...],
    values: NDArray[np.float64],
    std: NDArray[np.float64],
) -> FaceFit:
    """The fit with what a clip adds to the extents that it knows.

    names: P muscles; values, std: N x P, in units of the assumed strengths. The measured maximum is
    hardly the furthest that the muscle can go: a held expression comes near it again and again.
    """
    extent = fit.calibration.extent_factors(names)
    largest = values.max(axis=0)
    error = np.take_along_axis(std, values.argmax(axis=0)[None], axis=0)[0]
    further = np.maximum(largest, np.minimum(largest + error, HEADROOM))
    extent = np.where(largest > extent, further, extent)
    known = {name: float(one) for name, one in zip(names, extent, strict=True) if one > 1}
    return replace(fit, calibration=replace(fit.calibration, extent=known))


def stated(
    fit: FaceFit,
    anatomy: Anatomy,
    values: NDArray[np.float64],
    std: NDArray[np.float64],
    evidence: NDArray[np.float32],
) -> dict[str, Any]:
    """Fields of a performance: muscles' values and deviations (N x P), and what the pictures say of
    them (N x E, `_core.pack_evidence`), relative to the extents."""
    if not fit.calibration.extent:
        return {
            "activations": np.clip(values, 0, 1),
            "activations_std": std,
            "evidence": evidence,
        }
    extent = fit.calibration.extent_factors(anatomy.muscle_names)
    num_others = len(anatomy.articulator_names)
    return {
        "activations": np.clip(values / extent, 0, 1),
        "activations_std": std / extent,
        "evidence": evidence * evidence_factors(np.append(extent, np.ones(num_others))),
        "muscle_modes": anatomy.muscle_modes * extent[:, None, None],
        "muscle_extent": extent,
    }


def assumed_modes(performance: Performance) -> NDArray[np.float32]:
    """P x V x 3: of the muscles as strong as is assumed."""
    if performance.muscle_extent is None:
        return performance.muscle_modes
    factors = performance.muscle_extent.astype(np.float32)
    return performance.muscle_modes / factors[:, None, None]


def assumed_anatomy(performance: Performance, names: list[str], columns: list[int]) -> Anatomy:
    """Its muscles as strong as is assumed, and articulators by their names and columns."""
    limits = articulator_limits()
    if unknown := [name for name in names if name not in limits]:
        raise InvalidInput(f"this version knows no articulator {unknown[0]}: update Mimetic")
    assert performance.articulator_modes is not None
    return Anatomy(
        tuple(performance.muscles),
        performance.groups.astype(np.int32),
        assumed_modes(performance),
        np.zeros(len(performance.muscles)),
        tuple(names),
        performance.articulator_modes[columns],
        np.array([limits[name] for name in names], dtype=np.float64).reshape(-1, 2),
    )
