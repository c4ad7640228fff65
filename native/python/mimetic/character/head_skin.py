# SPDX-License-Identifier: GPL-3.0-or-later
"""A foreign head's skin with all that is read from the template registered to it.

How muscles, jaw and lips move it is solved in two ways: `solved_skin`, `carried_skin`.
"""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import InvalidInput, _core
from mimetic.character.face_units import BoundSkin, FaceUnits, face_units
from mimetic.character.foreign_holes import hole_notes
from mimetic.character.foreign_mesh import ForeignSkin
from mimetic.character.foreign_registration import lipped, lipped_skin
from mimetic.character.loose_parts import LooseParts
from mimetic.muscles.anatomy import SIDES, AttachedSkin
from mimetic.muscles.articulators import EyeFrame, EyeLids, Jaw, rotate
from mimetic.muscles.contact import eye_rest, lid_slit, lip_slit
from mimetic.muscles.extras import Extras, collect, gaze_of, gaze_rows, loading_names
from mimetic.skin.mesh import SkinMesh, multiply

TOO_FAR = 0.015  # m from the registered template: body, hair; such skin is held
TOUCH_GAP = 0.003  # m; points of the template's lips and lids so near to the skin can touch


class HeadSkin(ABC):
    """Modes over the whole mesh of V vertices, N of them the skin's; the template's frame, size."""

    def __init__(self, skin: ForeignSkin, template_mesh: SkinMesh):
        self.skin, self.template_mesh = skin, template_mesh
        self.loose = LooseParts(skin, template_mesh.neutral, template_mesh.template)
        self.moves_with = skin.skin_vertex.copy()
        self.moves_with[self.loose.following] = self.loose.roots
        self.notes = skin.notes + self.loose.notes
        self.eye_frames = {  # about the head's own eyeballs, where it has such
            side: EyeFrame(template_mesh, side, self.loose.ball_centres[side]) for side in SIDES
        }
        self.own = lipped_skin(skin, template_mesh)
        self.source = lipped(template_mesh)
        self.places = self.source.find(skin.vertices, self.own.normals, self.own.lip)
        self.template_skin = AttachedSkin(template_mesh, 1.0)
        free = multiply(template_mesh.stencils, self.template_skin.free.astype(float))
        self.free = (self.places.values(free) > 0.5) & (self.places.gaps < TOO_FAR)
        if not self.free.any():
            raise InvalidInput("no skin of the head lies where a face has skin")
        self.notes += hole_notes(skin, template_mesh, self.free)
        self.seam = self._find_seam()
        self.is_sealed = bool(self.seam.any())

    @abstractmethod
    def _pulls(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """M x N x 3 of the muscles at unit strength, and their strengths."""

    @abstractmethod
    def _with_jaw(self, jaw: Jaw, head: _core.HeadOnJaw) -> NDArray[np.float64]:
        """3 x V x 3."""

    @abstractmethod
    def _loadings(self) -> NDArray[np.float64]:
        """E x N x 3, of the extras that load the skin."""

    @abstractmethod
    def _yielding(self) -> tuple[_core.SkinModel, list[bool], _core.CompressedRows | None]:
        """What `_core.SkinContact` needs of the skin's stiffness: model, free, carrier."""

    def _find_seam(self) -> NDArray[np.bool_]:
        """Skin over a mouth that is not cut open."""
        marks = self.skin.landmarks
        inner = np.array([marks[f"lip_{lip}_inner"] for lip in ("upper", "lower")])
        corners = np.array([marks[f"mouth_corner.{side}"] for side in SIDES])
        return _core.find_seam(self.skin.vertices, self.skin.triangles, inner, corners)

    def muscle_modes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """M x V x 3 and M strengths, in the template's frame and size."""
        responses, strengths = self._pulls()
        return self._to_mesh(responses * strengths[:, None, None]), strengths

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
        return self._with_jaw(jaw, head)

    def extra_modes(self) -> Extras:
        """In the template's frame and size; gaze turns the loose parts that are eyes."""
        modes = dict(zip(loading_names(), self._to_mesh(self._loadings()), strict=True))
        for frame in self.eye_frames.values():
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
                triangles=self.skin.triangles,
                surface=self.skin.surface,
                places=self.places,
                onto=self._onto,
                spread=self._to_mesh,
                head_vertices=self.skin.user_vertices,
                read=self.skin.first_vertex,
                on_jaw=self.loose.on_jaw,
                eyes=[(frame, self._eye_surface(frame)) for frame in self.eye_frames.values()],
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
        model, free, carrier = self._yielding()
        return _core.SkinContact(
            rest=on_slits.values(self.skin.vertices)[rows],
            stencils=self._rows(on_slits.corners[rows], on_slits.weights[rows]),
            slits=slits,
            eyes=[self._eye_rest(frame) for frame in self.eye_frames.values()],
            model=model,
            free=free,
            carrier=carrier,
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

    def _eye_surface(self, frame: EyeFrame) -> _core.EyeSurface:
        own = self.skin.user_triangles
        own = np.ascontiguousarray(own[self.loose.eyes[frame.side][own].all(axis=1)])
        return _core.EyeSurface(frame.centre, self.skin.user_vertices, own)

    def lid_modes(self) -> list[NDArray[np.float64]]:
        modes = []
        for frame in self.eye_frames.values():
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
