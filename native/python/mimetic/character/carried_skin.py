# SPDX-License-Identifier: GPL-3.0-or-later
"""A foreign head's skin that is too fine to be solved: the registered template's skin carries it.

The template has the same bone, muscles and openings at a density that a face needs. Each vertex of
the head moves as the place on it that is nearest, inside from outside and upper from lower lip
distinguished; farther off the less (`_core.carrier_rows`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.character.head_skin import TOO_FAR, HeadSkin
from mimetic.muscles.anatomy import pull
from mimetic.muscles.articulators import Jaw
from mimetic.muscles.extras import loading_responses
from mimetic.skin.mesh import SkinMesh, canonical_skin, multiply


class CarriedSkin(HeadSkin):
    """The template's skin is factored when this is made."""

    def __init__(self, skin: ForeignSkin, template_mesh: SkinMesh):
        super().__init__(skin, template_mesh)
        if self.is_sealed:
            self.notes += ("upper and lower lip are one surface, which stretches as they part",)
        self.carrier = _core.carrier_rows(self.places, template_mesh.stencils, TOO_FAR)
        self.template_skin.factor()

    def _carry(self, responses: NDArray[np.float64]) -> NDArray[np.float64]:
        """M x S x 3 of the template's control vertices -> M x N x 3."""
        return np.stack([multiply(self.carrier, response) for response in responses])

    def _pulls(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        pulls = pull(self.template_skin, canonical_skin(self.template_mesh.template))
        return self._carry(pulls.responses), pulls.strengths

    def _with_jaw(self, jaw: Jaw, head: _core.HeadOnJaw) -> NDArray[np.float64]:
        mesh = self.template_mesh
        modes = _core.jaw_modes(self.template_skin, jaw, _core.HeadOnJaw.of(mesh, jaw))
        count = int(mesh.template.num_skin_vertices)
        return _core.jaw_on_head(self._carry(modes[:, :count]), jaw, head)

    def _loadings(self) -> NDArray[np.float64]:
        return self._carry(loading_responses(self.template_skin))

    def _yielding(self) -> tuple[_core.SkinModel, list[bool], _core.CompressedRows]:
        return self.template_skin.model, self.template_skin.free.tolist(), self.carrier
