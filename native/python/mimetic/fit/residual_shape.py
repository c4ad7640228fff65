# SPDX-License-Identifier: GPL-3.0-or-later
"""Ways in which a face may differ from every combination of the identity modes.

A skin held elastically to the canonical head is pulled at places all over the face; what it does
between them is the smooth deformation of least elastic energy. Energy gives the prior too: taken
as exp(-energy), it says how likely each deformation is [Terzopoulos 1988, regularised surfaces],
and its principal components over the face are the modes here. The materials are not the face's:
shape must be as free across the skin as along it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.mode_signs import RESIDUAL_REVERSED, signs
from mimetic.skin.mesh import SkinMesh, keep_columns, split_quads
from mimetic.template.face_template import FaceTemplate
from mimetic.template.regions import FACE

PULL_RADIUS = 0.008  # metres, s.d.
PLACES = 40  # where the skin is pulled, landmarks among them
SPREAD, ODD_SPREAD = 0.0010, 0.0004  # metres, rms over the face, mirrored alike and opposed
LEAST_VARIANCE = 0.02  # of the largest mode's: what is finer is left out
HELD = ("ear", "scalp")
YOUNG, POISSON, THICKNESS, PRE_STRESS = 4e4, 0.49, 1.5e-3, 2e4  # Pa, 1, m, Pa: data/materials.toml
ATTACHMENT = 1e5  # N/m^3, both along and across: deformations reach about 2 cm


@lru_cache(maxsize=2)
def residual_modes(template: FaceTemplate) -> NDArray[np.float64]:
    """M x V x 3 metres at one prior standard deviation; even modes under the mirror, then odd."""
    skin = held_skin(template)
    points = np.ascontiguousarray(template.vertices[: template.num_skin_vertices])
    on_face = template.in_region(*FACE)
    face, places = np.flatnonzero(on_face).tolist(), _places(template)
    modes = []
    for parity, spread in ((1, SPREAD), (-1, ODD_SPREAD)):
        pulls = _core.paired_pulls(points, places, on_face, PULL_RADIUS, parity)
        modes.append(_core.elastic_modes(pulls, skin(pulls), face, spread, LEAST_VARIANCE))
    skin_modes = np.concatenate(modes)
    mode_signs = signs(RESIDUAL_REVERSED, len(skin_modes))[:, None, None]
    return with_parts(template, mode_signs * skin_modes)


def _places(template: FaceTemplate) -> list[int]:
    """Vertices of the face's left half and midline, well apart, the landmarks first."""
    points = template.vertices[: template.num_skin_vertices]
    is_allowed = template.in_region(*FACE) & (points[:, 0] > -1e-6)
    landmarks = [int(v) for v in template.landmark_vertices if is_allowed[v]]
    return _core.spread_rows(points, landmarks, is_allowed.tolist(), PLACES)


def held_skin(
    template: FaceTemplate, attachment: float = ATTACHMENT
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """A function from forces N x S x 3 on the canonical head's skin to what it does, N x S x 3.

    attachment: N/m^3, of the skin to the head
    """
    count = template.num_skin_vertices
    points = np.ascontiguousarray(template.vertices[:count])
    is_free = ~(template.in_region(*HELD) | (template.in_region("neck") & (points[:, 2] < 0)))
    ones = np.ones(count)
    rows = np.arange(count + 1, dtype=np.int32)
    model = _core.SkinModel(
        points,
        split_quads(points, template.skin_faces),
        _core.SkinMaterials(
            young=YOUNG * ones,
            poisson=POISSON * ones,
            thickness=THICKNESS * ones,
            pre_stress=PRE_STRESS * ones,
            tangential=attachment * ones,
            normal=attachment * ones,
        ),
        keep_columns(_core.CompressedRows(rows, rows[:-1], ones, count), is_free),
    )

    def respond(forces: NDArray[np.float64]) -> NDArray[np.float64]:
        displacements = np.zeros(forces.shape)
        solution = model.solve(forces.reshape(len(forces), -1).T)
        displacements[:, is_free] = solution.T.reshape(len(forces), -1, 3)
        return displacements

    return respond


def with_parts(template: FaceTemplate, skin: NDArray[np.float64]) -> NDArray[np.float64]:
    """N x V x D of N x S x D: eyeballs and lashes go with lids, teeth and tongue with the lips."""
    mesh = SkinMesh(template, template.vertices)
    lids = mesh.vertices_between("skin", "eye_socket")
    lips = mesh.vertices_between("skin", "mouth_cavity")
    left = template.vertices[lids, 0] > 0
    leaders_of_parts = {"teeth_upper": lips, "teeth_lower": lips, "tongue": lips}
    for side, its_lids in (("L", lids[left]), ("R", lids[~left])):
        leaders_of_parts |= {f"eye.{side}": its_lids, f"lashes.{side}": its_lids}
    modes = np.zeros((len(skin), len(template.vertices), skin.shape[2]))
    modes[:, : skin.shape[1]] = skin
    for part, leaders in leaders_of_parts.items():
        inner = template.part_vertices(part)
        inner = inner[inner >= skin.shape[1]]
        modes[:, inner] = skin[:, leaders].mean(axis=1, keepdims=True)
    return modes
