# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles, jaw, lids, extras and contact on any head's own mesh, given by landmarks.

The template is registered to the head (`foreign_registration`). What anatomy says by region (the
materials, which skin is held, how far it follows the jaw, how far lids turn) is read from there;
the skin itself is solved on the head's own triangles, or carried by the template's
(`carried_skin`).
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.character.carried_skin import CarriedSkin
from mimetic.character.face_units import FaceUnits
from mimetic.character.foreign_mesh import ForeignSkin, read_skin
from mimetic.character.foreign_registration import lay_template
from mimetic.character.head_skin import HeadSkin
from mimetic.character.solved_skin import SolvedSkin
from mimetic.muscles.anatomy import SIDES, Anatomy, muscle_groups, muscle_names, muscle_table
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.extras import Extras
from mimetic.shared.progress import Progress, check_goes_on, stages
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate

MOST_SOLVED = 20_000  # vertices of a skin; finer ones are carried: `scripts/bench_bind`
COSTS = 3.0, 0.7, 0.3  # seconds: registering the template, factoring the skin, the modes


@dataclass(frozen=True)
class ForeignHead:
    """A head of any mesh with its muscles.

    anatomy and extras: modes over the mesh's own V vertices, in its own axes, metres; strengths:
    newtons; make_contact: the contact of its lips and lids, in these axes, solved when asked for;
    make_units: ARKit's 52 shapes, likewise;
    registered: the template's vertices registered to the head, mesh coordinates; eye_centers:
    2 x 3, left first, likewise; eye_of_vertex: V, 1 of the left eyeball, 2 of the right, else 0;
    mesh_from_template: from the template's axes and size; gap_mm:
    median and 95 % distance of the free skin from the registered template; notes: what was
    assumed or repaired.
    """

    anatomy: Anatomy
    extras: Extras
    make_contact: Callable[[], _core.SkinContact]
    make_units: Callable[[], FaceUnits]
    registered: NDArray[np.float64]
    eye_centers: NDArray[np.float64]
    eye_of_vertex: NDArray[np.int32]
    mesh_from_template: _core.Similarity
    gap_mm: tuple[float, float]
    notes: tuple[str, ...]


def attach_foreign(
    vertices: ArrayLike,
    faces: ArrayLike,
    landmarks: Mapping[str, int | ArrayLike],
    template: FaceTemplate,
    progress: Progress | None = None,
) -> ForeignHead:
    """Attach muscles, jaw and lids to any head.

    vertices: V x 3, metres, axes and origin as they are, x, y, z right-handed; faces: F x 3 or
    F x 4, outward, a triangle among quads ends in -1; landmarks: name -> index of a vertex or
    point x, y, z on the skin. Needed are `foreign_mesh.REQUIRED`, all of the template's are taken;
    .L is the subject's own left. Eyes must be open. The mouth may be open, closed, with or without
    a lining; if its lips are one surface, their seam is made soft and a note says so.
    progress: False raises KeyboardInterrupt. Raises InvalidInput, naming the landmark, face or
    vertex, on missing and unknown landmarks, a head that is not in metres or mirrored, more than a
    million vertices, and a skin that is not one well-formed piece.
    """
    laying, factoring, attaching = stages(progress, *COSTS)
    skin = read_skin(vertices, faces, landmarks, template)
    template_mesh = lay_template(template, skin, laying)
    with skin.named_by_caller():
        check_goes_on(factoring, 0.0, "making the skin that muscles move")
        head = _head_skin(skin, template_mesh)
        check_goes_on(attaching, 0.0, "attaching the muscles")
        modes, strengths = head.muscle_modes()
        bones = [*head.jaw_modes(), *head.lid_modes()]
        check_goes_on(attaching, 0.7, "attaching lips and gaze")
        extras = head.extra_modes()
    own_bones = dict(zip(ARTICULATORS, bones, strict=True))
    own_gaze = dict(zip(extras.names, extras.modes, strict=True))
    to_user = skin.user_from_skin
    anatomy = Anatomy(
        muscle_names=muscle_names(),
        groups=muscle_groups(),
        muscle_modes=to_user.turn(modes),
        muscle_strengths=strengths * _force_scales(to_user.scale),
        articulator_names=tuple(ARTICULATORS),
        articulator_modes=to_user.turn(np.stack(bones)),
        articulator_limits=np.array(list(ARTICULATORS.values())),
    )
    gaps = 1e3 * to_user.scale * head.places.gaps[head.free]
    return ForeignHead(
        anatomy=anatomy,
        extras=dataclasses.replace(extras, modes=to_user.turn(extras.modes)),
        make_contact=lambda: head.contact().turned(to_user.scale * to_user.rotation),
        make_units=lambda: head.units({**own_bones, **own_gaze}, to_user),
        registered=to_user.apply(template_mesh.neutral),
        eye_centers=to_user.apply(np.array([frame.centre for frame in head.eye_frames.values()])),
        eye_of_vertex=head.loose.eye_of_vertex(),
        mesh_from_template=to_user,
        gap_mm=(float(np.median(gaps)), float(np.percentile(gaps, 95))),
        notes=head.notes,
    )


def _head_skin(skin: ForeignSkin, template_mesh: SkinMesh) -> HeadSkin:
    """Solved by itself, or, where that takes long, carried."""
    kind = SolvedSkin if len(skin.vertices) <= MOST_SOLVED else CarriedSkin
    return kind(skin, template_mesh)


def _force_scales(scale: float) -> NDArray[np.float64]:
    """M: forces go with a muscle's cross-section, a sphincter's tension with its thickness."""
    is_ring = [row["type"] == "sphincter" for row in muscle_table() for _ in SIDES]
    return np.where(is_ring, scale, scale**2)
