# SPDX-License-Identifier: GPL-3.0-or-later
"""A foreign head's skin that is solved on its own triangles."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.character.head_skin import HeadSkin
from mimetic.muscles.anatomy import MATERIALS, AnatomyPerturbation, place_muscles
from mimetic.muscles.articulators import Jaw
from mimetic.muscles.extras import place_extras
from mimetic.skin.mesh import SkinMesh, canonical_skin

SEAM_STIFFNESS = 0.05  # times young and pre-stress, where the lips are one surface


class SolvedSkin(HeadSkin):
    """Factored when it is made."""

    def __init__(self, skin: ForeignSkin, template_mesh: SkinMesh):
        super().__init__(skin, template_mesh)
        outer = np.zeros(len(template_mesh.vertices))
        outer[np.unique(template_mesh.triangles[template_mesh.triangle_part == "skin"])] = 1
        carries = (self.places.values(outer) > 0.5)[skin.triangles].any(axis=1)
        carries = carries & ~self.seam[skin.triangles].all(axis=1)
        self.surface = _core.MuscleSurface(skin.vertices, skin.triangles, carries)
        if self.is_sealed:
            self.notes += ("upper and lower lip are one surface: their seam was made soft",)
        self.attached_skin = self._attach()
        self.model = self.attached_skin.model

    def _attach(self) -> _core.AttachedSkin:
        materials = self.template_skin.materials
        values = {name: self.places.values(getattr(materials, name)) for name in MATERIALS}
        for name in ("young", "pre_stress"):
            values[name][self.seam] *= SEAM_STIFFNESS
        own = _core.SkinMaterials(**values)
        return _core.AttachedSkin(self.skin.vertices, self.skin.triangles, own, self.free)

    def _pulls(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        canonical = canonical_skin(self.template_mesh.template)
        muscles = [
            muscle.carried(self._carry(muscle.muscle.insertion))
            for muscle in place_muscles(canonical, self.template_mesh, AnatomyPerturbation())
        ]
        pulls = _core.pull(self.attached_skin, self.surface, muscles, self._measured(muscles))
        return pulls.responses, pulls.strengths

    def _with_jaw(self, jaw: Jaw, head: _core.HeadOnJaw) -> NDArray[np.float64]:
        return _core.jaw_modes(self.attached_skin, jaw, head)

    def _loadings(self) -> NDArray[np.float64]:
        extras = [
            extra.carried(self._carry(extra.line)) for extra in place_extras(self.template_mesh)
        ]
        mouth = _core.MouthFrame(self.template_mesh)
        return _core.extra_responses(
            self.attached_skin, self.surface, mouth, extras, self._measured(extras)
        )

    def _yielding(self) -> tuple[_core.SkinModel, list[bool], None]:
        return self.model, self.free.tolist(), None

    def _carry(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Places on the registered template's skin to those on this one."""
        frontal = self.template_mesh.seen_from_front
        vertex = frontal[_core.nearest(points, self.template_mesh.vertices[frontal])]
        return self._onto(vertex, points).values(self.skin.vertices)

    def _measured(
        self, movers: Sequence[_core.PlacedMuscle] | Sequence[_core.PlacedExtra]
    ) -> _core.CompressedRows:
        """Rows that read the motion of the places by which muscles or extras are measured."""
        places = [one.measured for one in movers]
        points = np.array([place.position(self.template_mesh) for place in places])
        at = self._onto([place.vertex for place in places], points)
        return self._rows(at.corners, at.weights)
