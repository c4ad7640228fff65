# SPDX-License-Identifier: GPL-3.0-or-later
"""Lips rest on each other and lids on each other: contact without friction, for shapes at rest.

`_core.SkinContact` finds the forces that part them; here is where on a head of the template's mesh
they can touch. Forces are vertical: across the slits of a head that stands upright. Lids slide on
the eye: what would sink into it is put back to its distance from the eye's centre. Metres, head
frame.
"""

from __future__ import annotations

import warnings
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.muscles.anatomy import SIDES, AttachedSkin, attach_skin
from mimetic.muscles.articulators import LID_REACH, EyeFrame, eye_frames
from mimetic.skin.mesh import SkinMesh, split_quads
from mimetic.template.face_template import load_template

KEPT = 4  # heads in memory, some 20 MB each


def contact_on(neutral: NDArray[np.float64]) -> _core.SkinContact:
    """The contact of a head of the template's mesh at rest (V x 3), made once for heads that are
    alike to single precision. Raises InvalidInput as `anatomy.attach_skin` does; its warnings are
    for who makes the head and are left out."""
    return _contact_on(np.ascontiguousarray(neutral, dtype=np.float32).tobytes())


@lru_cache(maxsize=KEPT)
def _contact_on(neutral: bytes) -> _core.SkinContact:
    vertices = np.frombuffer(neutral, dtype=np.float32).reshape(-1, 3).astype(np.float64)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return attach_contact(attach_skin(vertices, load_template()))


def attach_contact(skin: AttachedSkin) -> _core.SkinContact:
    """Contact on a person whose skin is attached (`anatomy.attach_skin`)."""
    mesh, count = skin.mesh, len(skin.free)
    slits = [lip_slit(mesh), *(lid_slit(mesh, side) for side in SIDES)]
    vertices, slits = _core.number_slits(slits, [True] * len(mesh.vertices))
    return _core.SkinContact(
        rest=mesh.vertices[vertices],
        stencils=mesh.stencil_rows_at(vertices.tolist()),
        slits=slits,
        eyes=[eye_rest(mesh, frame) for frame in eye_frames(mesh)],
        model=skin.model,
        free=skin.free.tolist(),
        moves_with=skin.moves_with.tolist(),
        read=list(range(count)),
    )


def eye_rest(mesh: SkinMesh, frame: EyeFrame) -> _core.EyeRest:
    """Lids on an eye of a head of the template's mesh, control vertices."""
    margin = mesh.vertices[frame.margin]
    skin = mesh.neutral[: int(mesh.template.num_skin_vertices)]
    reach = LID_REACH * mesh.size
    return _core.rest_on_eye(mesh.whole_surface, margin, skin, frame.centre, reach, mesh.size)


def lip_slit(mesh: SkinMesh, is_refined: bool = True) -> _core.Slit:
    """The two lips as far as they can touch, the mouth's lining behind them included.

    is_refined: all vertices of the refined skin, or those alone that are its control vertices'
    limits.
    """
    triangles = mesh.triangles if is_refined else split_quads(mesh.vertices, mesh.faces)
    margin = mesh.vertices[mesh.vertices_between("skin", "mouth_cavity")]
    inner = mesh.vertices[[mesh.landmark(f"lip_{lip}_inner") for lip in ("upper", "lower")]]
    return _core.lip_slit(mesh.vertices, triangles, mesh.whole_surface, margin, inner, mesh.size)


def lid_slit(mesh: SkinMesh, side: str) -> _core.Slit:
    """The rims of one eye's lids, without the corners that they share."""
    rims = mesh.vertices_between("skin", "eye_socket")
    margin = rims[(mesh.vertices[rims, 0] > 0) == (side == "L")]
    corners = mesh.vertices[[mesh.landmark(f"eye_{end}.{side}") for end in ("inner", "outer")]]
    return _core.lid_slit(mesh.vertices, margin, corners, mesh.size)
