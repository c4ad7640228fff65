# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles, jaw, lids, extras and contact on any head's own mesh, given by landmarks.

The template is registered to the head (`foreign_registration`). What anatomy says by region (the
materials, which skin is held, how far it follows the jaw, how far lids turn) is read from there;
the skin itself is solved on the head's own triangles.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.character.face_units import BoundSkin, FaceUnits, face_units
from mimetic.character.foreign_holes import hole_notes
from mimetic.character.foreign_mesh import ForeignSkin, read_skin
from mimetic.character.foreign_registration import lay_template, lipped, lipped_skin
from mimetic.character.loose_parts import LooseParts
from mimetic.muscles.anatomy import (
    MATERIALS,
    SIDES,
    Anatomy,
    AnatomyPerturbation,
    AttachedSkin,
    muscle_groups,
    muscle_names,
    muscle_table,
    place_muscles,
)
from mimetic.muscles.articulators import (
    ARTICULATORS,
    EyeFrame,
    EyeLids,
    Jaw,
    eye_frames,
    rotate,
)
from mimetic.muscles.contact import eye_rest, lid_slit, lip_slit
from mimetic.muscles.extras import (
    Extras,
    collect,
    gaze_of,
    gaze_rows,
    loading_names,
    place_extras,
)
from mimetic.shared.progress import Progress, check_goes_on, stages
from mimetic.skin.mesh import SkinMesh, canonical_skin, multiply
from mimetic.template.face_template import FaceTemplate

TOO_FAR = 0.015  # m from the registered template: body, hair; such skin is held
SEAM_STIFFNESS = 0.05  # times young and pre-stress, where the lips are one surface
COSTS = 3.0, 0.7, 0.3  # seconds: registering the template, factoring the skin, the modes
TOUCH_GAP = 0.003  # m; points of the template's lips and lids so near to the skin can touch


@dataclass(frozen=True)
class ForeignHead:
    """A head of any mesh with its muscles.

    anatomy and extras: modes over the mesh's own V vertices, in its own axes, metres; strengths:
    newtons; make_contact: the contact of its lips and lids, in these axes, solved when asked for;
    make_units: ARKit's 52 shapes, likewise;
    registered: the template's vertices registered to the head, mesh coordinates; eye_centers:
    2 x 3, left first, likewise; mesh_from_template: from the template's axes and size; gap_mm:
    median and 95 % distance of the free skin from the registered template; notes: what was
    assumed or repaired.
    """

    anatomy: Anatomy
    extras: Extras
    make_contact: Callable[[], _core.SkinContact]
    make_units: Callable[[], FaceUnits]
    registered: NDArray[np.float64]
    eye_centers: NDArray[np.float64]
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
        head = _Carried(skin, template_mesh)
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
        eye_centers=to_user.apply(
            np.array([frame.centre for frame in eye_frames(head.template_mesh)])
        ),
        mesh_from_template=to_user,
        gap_mm=(float(np.median(gaps)), float(np.percentile(gaps, 95))),
        notes=head.notes,
    )


def _force_scales(scale: float) -> NDArray[np.float64]:
    """M: forces go with a muscle's cross-section, a sphincter's tension with its thickness."""
    is_ring = [row["type"] == "sphincter" for row in muscle_table() for _ in SIDES]
    return np.where(is_ring, scale, scale**2)


class _Carried:
    """A foreign skin with all that is read from the template registered to it."""

    def __init__(self, skin: ForeignSkin, template_mesh: SkinMesh):
        self.skin, self.template_mesh = skin, template_mesh
        self.loose = LooseParts(skin, template_mesh.neutral, template_mesh.template)
        self.moves_with = skin.skin_vertex.copy()
        self.moves_with[self.loose.following] = self.loose.roots
        self.notes = skin.notes + self.loose.notes
        self.own = lipped_skin(skin, template_mesh)
        self.source = lipped(template_mesh)
        self.places = self.source.find(skin.vertices, self.own.normals, self.own.lip)
        template_skin = AttachedSkin(template_mesh, 1.0)
        free = multiply(template_mesh.stencils, template_skin.free.astype(float))
        self.free = (self.places.values(free) > 0.5) & (self.places.gaps < TOO_FAR)
        if not self.free.any():
            raise _core.InvalidInput("no skin of the head lies where a face has skin")
        self.notes += hole_notes(skin, template_mesh, self.free)
        outer = np.zeros(len(template_mesh.vertices))
        outer[np.unique(template_mesh.triangles[template_mesh.triangle_part == "skin"])] = 1
        carries = (self.places.values(outer) > 0.5)[skin.triangles].any(axis=1)
        seam = self._seam()
        self.is_sealed = bool(seam.any())
        self.carries = carries & ~seam[skin.triangles].all(axis=1)
        self.surface = _core.MuscleSurface(skin.vertices, skin.triangles, self.carries)
        self.attached_skin = self._attach(template_skin.materials, seam)
        self.model = self.attached_skin.model

    def _attach(
        self, template_materials: _core.SkinMaterials, seam: NDArray[np.bool_]
    ) -> _core.AttachedSkin:
        values = {name: self.places.values(getattr(template_materials, name)) for name in MATERIALS}
        for name in ("young", "pre_stress"):
            values[name][seam] *= SEAM_STIFFNESS
        materials = _core.SkinMaterials(**values)
        return _core.AttachedSkin(self.skin.vertices, self.skin.triangles, materials, self.free)

    def _seam(self) -> NDArray[np.bool_]:
        """Skin over a mouth that is not cut open."""
        marks = self.skin.landmarks
        inner = np.array([marks[f"lip_{lip}_inner"] for lip in ("upper", "lower")])
        corners = np.array([marks[f"mouth_corner.{side}"] for side in SIDES])
        seam = _core.find_seam(self.skin.vertices, self.skin.triangles, inner, corners)
        if seam.any():
            self.notes += ("upper and lower lip are one surface: their seam was made soft",)
        return seam

    def muscle_modes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """M x V x 3 and M strengths, in the template's frame and size."""
        canonical = canonical_skin(self.template_mesh.template)
        muscles = [
            muscle.carried(self._carry(muscle.muscle.insertion))
            for muscle in place_muscles(canonical, self.template_mesh, AnatomyPerturbation())
        ]
        pulls = _core.pull(self.attached_skin, self.surface, muscles, self._measured(muscles))
        return self._to_mesh(pulls.responses * pulls.strengths[:, None, None]), pulls.strengths

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

    def _rows(
        self, corners: NDArray[np.int32], weights: NDArray[np.float64]
    ) -> _core.CompressedRows:
        """K x N, from the corners and their weights (K x 3) of places on this skin."""
        starts = np.arange(0, corners.size + 1, 3)
        count = len(self.skin.vertices)
        return _core.CompressedRows(starts, corners.ravel(), weights.ravel(), count)

    def _onto(self, template_vertex: ArrayLike, points: NDArray[np.float64]) -> _core.SkinPlaces:
        """Places on this skin of points by vertices of the registered template."""
        vertex = np.atleast_1d(template_vertex)
        return self.own.find(
            np.atleast_2d(points), self.source.normals[vertex], self.source.lip[vertex]
        )

    def jaw_modes(self) -> NDArray[np.float64]:
        """3 x V x 3."""
        jaw = Jaw(self.template_mesh)
        head = _core.HeadOnJaw(
            skin=self.skin.vertices,
            influence=self.places.values(jaw.influence),
            vertices=self.skin.user_vertices,
            moves_with=self.moves_with,
            rigid=np.flatnonzero(self.loose.on_jaw).tolist(),
        )
        return _core.jaw_modes(self.attached_skin, jaw, head)

    def extra_modes(self) -> Extras:
        """In the template's frame and size; gaze turns the loose parts that are eyes."""
        extras = [
            extra.carried(self._carry(extra.line)) for extra in place_extras(self.template_mesh)
        ]
        mouth = _core.MouthFrame(self.template_mesh)
        responses = _core.extra_responses(
            self.attached_skin, self.surface, mouth, extras, self._measured(extras)
        )
        modes = dict(zip(loading_names(), self._to_mesh(responses), strict=True))
        for frame in eye_frames(self.template_mesh):
            eye, lids = self.loose.eyes[frame.side], EyeLids(frame)
            if not eye.any():
                side = "left" if frame.side == "L" else "right"
                self.notes += (f"no {side} eyeball was found: its gaze moves the lids alone",)
            for row in gaze_rows():
                gaze = gaze_of(row)
                angle = _core.lid_angle(lids, gaze) if row["axis"][0] else np.zeros(0)
                mode = self._to_mesh(self._turn_lids(frame, angle)[None])[0]
                mode[eye] = _core.turned_eye(frame, gaze, self.skin.user_vertices[eye])
                modes[f"{row['name']}.{frame.side}"] = mode
        return collect(modes)

    def units(
        self, own_modes: Mapping[str, NDArray[np.float64]], to_user: _core.Similarity
    ) -> FaceUnits:
        """ARKit's shapes in the caller's axes. own_modes: jaw, lids, gaze, the template's frame."""
        units = face_units(
            BoundSkin(
                template_mesh=self.template_mesh,
                vertices=self.skin.vertices,
                surface=self.skin.surface,
                places=self.places,
                onto=self._onto,
                spread=self._to_mesh,
                head_vertices=self.skin.user_vertices,
                read=self.skin.first_vertex,
                on_jaw=self.loose.on_jaw,
                is_sealed=self.is_sealed,
            ),
            own_modes,
        )
        return dataclasses.replace(units, modes=to_user.turn(units.modes))

    def contact(self) -> _core.SkinContact:
        """Contact of what the template's lips and lids lie on, in its frame and size."""
        # A touch point costs a solution on the head's own mesh, so there are fewer
        slits = [*(() if self.is_sealed else (lip_slit(self.template_mesh, is_refined=False),))]
        slits += [lid_slit(self.template_mesh, side) for side in SIDES]
        of_slits = np.unique(np.concatenate([np.r_[s.upper, s.lower] for s in slits]))
        on_slits = self._onto(of_slits, self.template_mesh.vertices[of_slits])
        is_near = np.zeros(len(self.template_mesh.vertices), bool)
        is_near[of_slits] = on_slits.gaps < TOUCH_GAP  # many a mesh ends behind the lips
        vertices, slits = _core.number_slits(slits, is_near.tolist())
        rows = np.searchsorted(of_slits, vertices)
        return _core.SkinContact(
            rest=on_slits.values(self.skin.vertices)[rows],
            stencils=self._rows(on_slits.corners[rows], on_slits.weights[rows]),
            slits=slits,
            eyes=[self._eye_rest(frame) for frame in eye_frames(self.template_mesh)],
            model=self.model,
            free=self.free.tolist(),
            moves_with=self.moves_with.tolist(),
            read=self.skin.first_vertex.tolist(),
        )

    def _eye_rest(self, frame: EyeFrame) -> _core.EyeRest:
        template_rest = eye_rest(self.template_mesh, frame)
        share = np.zeros(int(self.template_mesh.template.num_skin_vertices))
        share[template_rest.vertices] = template_rest.share
        share = self.places.values(multiply(self.template_mesh.stencils, share))
        own = np.flatnonzero(share > 0)
        return _core.EyeRest(
            template_rest.centre,
            own.tolist(),
            self.skin.vertices[own],
            share[own],
            template_rest.sink,
        )

    def lid_modes(self) -> list[NDArray[np.float64]]:
        modes = []
        for frame in eye_frames(self.template_mesh):
            for template_angle in EyeLids(frame).angles():
                modes.append(self._turn_lids(frame, template_angle))
        return list(self._to_mesh(np.stack(modes)))

    def _turn_lids(
        self, frame: EyeFrame, template_angle: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """N x 3: skin turned about an eye by the angles of the registered template (S, or none)."""
        points = self.skin.vertices
        if not len(template_angle):
            return np.zeros_like(points)
        angle = self.places.values(multiply(self.template_mesh.stencils, template_angle))
        return rotate(points, frame.centre, frame.axis, angle) - points

    def _to_mesh(self, displacements: NDArray[np.float64]) -> NDArray[np.float64]:
        """M x N x 3 of the skin -> M x V x 3: what is loose and near to the skin follows it."""
        return _core.spread(displacements, self.moves_with)
