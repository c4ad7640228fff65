# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of the template to another head: by landmarks, then as an elastic skin.

First a radial-basis warp through the landmarks, then rounds of non-rigid closest points (Amberg
2007), the first of them coarse, with our own shell as the regulariser: the foundation of
`_core.SkinModel` is the pull to the surface, strong across the skin and weak along it, its membrane
and bending keep the mesh even.
Metres, head frame, the template's size.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.shared.progress import Progress, check_goes_on
from mimetic.skin.mesh import SkinMesh, split_quads
from mimetic.template.face_template import FaceTemplate

REACHES = (0.030, 0.015, 0.010)  # m; of the pull in each round
LIPS = ("lip_upper", "lip_lower")


def lipped(mesh: SkinMesh) -> _core.LippedSurface:
    """A template-shaped head's refined skin."""
    return _core.LippedSurface(mesh.vertices, mesh.triangles, mesh.whole_surface, _lips(mesh))


def lipped_skin(skin: ForeignSkin, template_mesh: SkinMesh) -> _core.LippedSurface:
    """A foreign skin, its two lips distinguished by the registered template."""
    return _core.LippedSurface(skin.vertices, skin.triangles, skin.surface, _lips(template_mesh))


def _lips(mesh: SkinMesh) -> NDArray[np.float64]:
    return mesh.neutral[[mesh.landmark(name) for name in LIPS]]


def lay_template(
    template: FaceTemplate, skin: ForeignSkin, progress: Progress | None = None
) -> SkinMesh:
    """The template on another head's skin.

    progress: False raises KeyboardInterrupt. Raises InvalidInput if the landmarks cannot belong to
    this skin.
    """
    landmark_vertices = [template.landmark(name) for name in skin.landmarks]
    targets = np.array(list(skin.landmarks.values()))
    neutral = _core.warp_points(template.vertices, template.vertices[landmark_vertices], targets)
    with (
        warnings.catch_warnings()
    ):  # warnings about the template's own folds do not concern the caller
        warnings.simplefilter("ignore")
        mesh = _sound(template, neutral)
        if mesh is None:
            raise InvalidInput(
                "the landmarks do not fit a face (the template folds over on them): "
                f"check {', '.join(skin.landmarks)}"
            )
        for number, reach in enumerate(REACHES):
            check_goes_on(progress, number / len(REACHES), "fitting the template to the head")
            pull = partial(_draw, mesh, landmark_vertices, targets, skin, reach)
            closer = _coarsely(mesh, pull) if number == 0 else None
            closer = closer or _sound(template, pull(_refined(mesh)))
            if closer is None:  # it folded over: the round before fits less closely, without folds
                break
            mesh = closer
    return mesh


def _sound(template: FaceTemplate, neutral: NDArray[np.float64]) -> SkinMesh | None:
    try:
        mesh = SkinMesh(template, neutral)
        _ = mesh.vertices  # raises where faces stay turned over
    except InvalidInput:
        return None
    return mesh


@dataclass(frozen=True)
class _Patch:
    """The template's skin at one density: N vertices made of its control vertices."""

    skin: _core.LippedSurface
    stencils: _core.CompressedRows


def _refined(mesh: SkinMesh) -> _Patch:
    return _Patch(lipped(mesh), mesh.stencils)


def _coarse(mesh: SkinMesh) -> _Patch:
    """The limits of the control vertices alone: a third of the work, near enough to go on from."""
    count = int(mesh.template.num_skin_vertices)
    vertices = np.ascontiguousarray(mesh.vertices[:count])
    triangles = split_quads(mesh.vertices, mesh.faces)
    surface = _core.MuscleSurface(vertices, triangles, [True] * len(triangles))
    rows = np.arange(count + 1)
    own = _core.CompressedRows(rows, rows[:-1], np.ones(count), count)
    return _Patch(_core.LippedSurface(vertices, triangles, surface, _lips(mesh)), own)


def _coarsely(mesh: SkinMesh, pull: Callable[[_Patch], NDArray[np.float64]]) -> SkinMesh | None:
    """None where so few vertices fold over."""
    try:
        return _sound(mesh.template, pull(_coarse(mesh)))
    except InvalidInput:
        return None


def _draw(
    mesh: SkinMesh,
    landmark_vertices: list[int],
    targets: NDArray[np.float64],
    skin: ForeignSkin,
    reach: float,
    patch: _Patch,
) -> NDArray[np.float64]:
    """One round: neutral V x 3 after the skin was drawn to what lies within reach."""
    template = mesh.template
    outer = np.zeros(len(mesh.vertices), bool)
    outer[np.unique(mesh.triangles[mesh.triangle_part == "skin"])] = True
    edge = mesh.vertices_between("skin", "eye_socket")
    is_left = mesh.neutral[edge, 0] > 0
    mouth = mesh.vertices_between("skin", "mouth_cavity")
    followers = [  # eyes and lashes go with their lids
        (edge[is_left], template.part_vertices("eye.L", "lashes.L")),
        (edge[~is_left], template.part_vertices("eye.R", "lashes.R")),
        (mouth, template.part_vertices("teeth_upper", "teeth_lower", "tongue")),
    ]
    return _core.draw_to_surface(
        neutral=mesh.neutral,
        skin=patch.skin,
        outer=outer[: len(patch.skin.vertices)],
        stencils=patch.stencils,
        held=landmark_vertices,
        followers=[(leaders.tolist(), parts.tolist()) for leaders, parts in followers],
        targets=targets,
        surface=lipped_skin(skin, mesh),
        reach=reach,
    )
