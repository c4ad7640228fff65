# SPDX-License-Identifier: GPL-3.0-or-later
"""How faces differ, as few independent coefficients as a fit needs.

Identity modes and residual modes overlap, and hundreds of them are more than a picture
determines. Their joint prior over the face has principal components; the solver moves along those,
and each set of components stands for the likeliest identity and residual coefficients.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.fit.mode_signs import COMPONENTS_REVERSED, signs
from mimetic.fit.residual_shape import residual_modes
from mimetic.template.face_template import FaceTemplate
from mimetic.template.regions import FACE

# Modes that a face seen from the front says nothing about
UNSEEN = ("ear_", "neck_", "asym_ear", "asym_temple", "head_back", "forehead_", "head_scale_depth")
# Spreads of the identity modes make distances of the face differ as much as between adults
# [Farkas 1994]: nose to chin by 5 mm, subnasale to stomion 2.5, alae 3, zygions 7, gonions 7.
LIKELY_MOVE = 0.0025  # metres at one standard deviation, at the vertex that a mode moves most
LARGEST_SPREAD = 0.25
ODD_SPREAD = 0.3  # of the spread of an even mode
MOST_COMPONENTS = 96


@dataclass(frozen=True, eq=False)
class FaceShape:
    """K components with a unit normal prior each; I identity and M residual coefficients."""

    identity_names: list[str]  # I
    coefficients: NDArray[np.float64]  # (I + M) x K, identity then residual, of one component each
    components: NDArray[np.float64]  # K x V x 3, metres

    def split(self, values: NDArray[np.float64]) -> tuple[dict[str, float], list[float]]:
        """Identity by name and residual coefficients of component values (K)."""
        all_values = self.coefficients @ values
        count = len(self.identity_names)
        identity = zip(self.identity_names, all_values[:count], strict=True)
        return (
            {name: round(float(value), 6) for name, value in identity},
            [round(float(value), 6) for value in all_values[count:]],
        )

    def joined(self, identity: dict[str, float], residual: list[float]) -> NDArray[np.float64]:
        """Component values (K) nearest to the coefficients; raises InvalidInput."""
        if unknown_names := sorted(identity.keys() - set(self.identity_names)):
            raise InvalidInput(f"a fit has no identity mode {', '.join(unknown_names)}: fit again")
        count = len(self.coefficients) - len(self.identity_names)
        coefficients = [identity.get(name, 0.0) for name in self.identity_names]
        coefficients += list(residual) or [0.0] * count
        if len(coefficients) != len(self.coefficients):
            raise InvalidInput(
                f"the fit has {len(residual)} residual coefficients, this head {count}: fit again"
            )
        return _core.nearest_coefficients(
            self.coefficients, np.array(coefficients, dtype=np.float64)
        )


def identity_names(template: FaceTemplate) -> list[str]:
    """Identity modes that a fit may use."""
    return [name for name in template.identity_names if not name.startswith(UNSEEN)]


@lru_cache(maxsize=6)
def face_shape(
    template: FaceTemplate, with_identity: bool = True, with_residual: bool = True
) -> FaceShape:
    """The components of a head's modes, or of one kind of them alone."""
    names = identity_names(template)
    indices = [template.identity_names.index(name) for name in names]
    identity = template.identity_modes[indices].astype(np.float64)
    residual = residual_modes(template)
    spread = np.append(
        _identity_spread(template, names, identity) * with_identity,
        np.full(len(residual), float(with_residual)),
    )
    likely = np.concatenate([identity, residual]) * spread[:, None, None]
    face = np.flatnonzero(template.in_region(*FACE)).tolist()
    shares, components = _core.principal_shapes(likely, face, MOST_COMPONENTS)
    component_signs = signs(COMPONENTS_REVERSED, len(components))
    return FaceShape(
        names,
        spread[:, None] * shares * component_signs,
        component_signs[:, None, None] * components,
    )


def _identity_spread(
    template: FaceTemplate, names: Sequence[str], modes: NDArray[np.floating]
) -> NDArray[np.float64]:
    largest = np.abs(modes[:, : template.num_skin_vertices]).max(axis=(1, 2))
    spread = np.minimum(LARGEST_SPREAD, LIKELY_MOVE / np.maximum(largest, 1e-4))
    return spread * [ODD_SPREAD if name.startswith("asym_") else 1.0 for name in names]
