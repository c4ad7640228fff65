# SPDX-License-Identifier: GPL-3.0-or-later
"""What muscles cannot explain of a face's motion: wrinkles of its own, lips, the model's error.

The surface may still be drawn into low-energy modes of a skin, so that it follows the footage as
well as the flow does; the priors keep that weaker than the muscles, which stay readable. That skin
is held alike everywhere, and not by bone from region to region as the muscles' is: what muscles
leave unexplained is in the nose, the chin and the sides of the face, too, which they hardly move.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic.muscles.anatomy import AttachedSkin
from mimetic.muscles.modes import low_energy_modes, visible_area
from mimetic.skin.mesh import SkinMesh, multiply

NUM_MODES = 120
# One camera hardly sees depth: what it does not see must not be invented.
FRONTAL = (1, 1, 0)
# Without their own materials these would tie lip to lip and lid to lid.
UNLIKE = ("mouth_cavity", "eye_socket")
TYPICAL = 1.0  # mm, root mean square over the skin, of all modes together


@dataclass(frozen=True)
class Detail:
    """D modes of the whole head: D x V x 3, metres at the coefficient 1; std: D, prior."""

    modes: NDArray[np.float64]
    std: NDArray[np.float64]


def detail_of(
    mesh: SkinMesh, unmeasured_regions: tuple[str, ...], count: int = NUM_MODES
) -> Detail:
    """The modes of a person's skin but for the regions named."""
    count_skin = int(mesh.template.num_skin_vertices)
    weights = (~mesh.template.in_region(*unmeasured_regions))[:count_skin].astype(np.float64)
    even = AttachedSkin(mesh, 1, regions=UNLIKE)
    modes = low_energy_modes(
        even, count, visible_area(mesh) * multiply(mesh.stencils, weights), FRONTAL
    )
    share = modes.compliance / modes.compliance.sum()
    return Detail(modes.modes, TYPICAL * np.sqrt(share))
