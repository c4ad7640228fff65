# SPDX-License-Identifier: GPL-3.0-or-later
"""A head's skin under its muscles in time, and under large rotations.

What `anatomy` gives is the static, linear answer. Here the same skin with the same forces has mass,
damping and relaxation (SkinDynamics, or ReducedSkin in real time), or turns far (CorotationalSkin).
Loads: L, the muscles and 3 motions of the jaw, at value 1. Metres, newtons, seconds, head frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from mimetic import _core
from mimetic.muscles.anatomy import (
    AnatomyPerturbation,
    AttachedSkin,
    load_table,
    muscle_names,
    pull,
)
from mimetic.muscles.articulators import JAW, Jaw
from mimetic.muscles.calibration import Calibration
from mimetic.skin.mesh import CompressedRows, SkinMesh, canonical_skin
from mimetic.template.face_template import FaceTemplate

SUBSTEPS = 8  # of a frame at 30 a second: 1/240 s
NUM_MODES = (
    8  # of the reduced skin; `python -m evaluation.anatomy.motion_table` shows what more would give
)


@dataclass(frozen=True)
class LoadedSkin:
    """A person's skin with what moves it.

    skin: AttachedSkin; names: L; forces: L x N x 3 on the refined vertices at value 1, newtons.
    """

    skin: AttachedSkin
    names: tuple[str, ...]
    forces: np.ndarray

    @property
    def mesh(self) -> SkinMesh:
        return self.skin.mesh

    @cached_property
    def loads(self) -> np.ndarray:
        """3C x L newtons on the unknowns of `skin.model`."""
        return self.skin.model.loads(self.forces.reshape(len(self.forces), -1).T)

    @cached_property
    def mass(self) -> _core.SkinMass:
        """Skin and a third of the fat under it, by `data/materials.toml`."""
        motion = load_table("materials.toml")["motion"]
        density = motion["density"] * self.skin.materials.thickness
        density = density + motion["fat_density"] * motion["fat_depth"] / 3
        return _core.SkinMass(self.skin.model, self.mesh.vertices, self.mesh.triangles, density)

    def visible_stencils(self) -> CompressedRows:
        """Rows that make displacements of the skin seen from the front from the unknowns."""
        return self.stencils_of(self.mesh.seen_from_front)

    def stencils_of(self, refined_vertices: np.ndarray) -> CompressedRows:
        """Rows of the model's basis for some refined vertices."""
        return self.skin.basis_at(refined_vertices.tolist())

    def dynamics(self, options: _core.DynamicsOptions) -> _core.SkinDynamics:
        """The whole skin in time; advance it by `loads @ values`."""
        return _core.SkinDynamics(self.skin.model, self.mass, options)

    def reduced(
        self, options: _core.DynamicsOptions, num_modes: int = NUM_MODES
    ) -> _core.ReducedSkin:
        """The same in real time; advance it by L values."""
        return _core.ReducedSkin(self.skin.model, self.mass, self.loads, num_modes, options)

    def corotational(self) -> _core.CorotationalSkin:
        """The same skin under large rotations; solve it for `forces` as 3N values."""
        mesh = self.mesh
        return _core.CorotationalSkin(
            mesh.vertices,
            mesh.triangles,
            self.skin.materials,
            self.skin.basis,
        )


def load_skin(
    neutral_vertices: ArrayLike,
    template: FaceTemplate,
    *,
    perturbation: AnatomyPerturbation | None = None,
    calibration: Calibration | None = None,
) -> LoadedSkin:
    """A head's skin with the forces that give `modes_of`'s modes; arguments of `attach_skin`."""
    perturbation = perturbation or AnatomyPerturbation()
    neutral = np.ascontiguousarray(neutral_vertices, dtype=np.float64)
    mesh = SkinMesh(template, neutral)
    skin = AttachedSkin(mesh, perturbation.stiffness_factor, calibration)
    pulls = pull(skin, canonical_skin(template), perturbation)
    jaw = Jaw(mesh)
    jaw_forces = skin.foundation_forces(np.stack([jaw.under_skin(name) for name in JAW]))
    return LoadedSkin(
        skin,
        (*muscle_names(), *JAW),
        np.concatenate([pulls.forces * pulls.strengths[:, None, None], jaw_forces]),
    )


def dynamics_options(
    step: float = 1 / 240, scheme: _core.TimeScheme = _core.TimeScheme.newmark
) -> _core.DynamicsOptions:
    """Damping and relaxation of `data/materials.toml`; step: s."""
    motion = load_table("materials.toml")["motion"]
    keys = ("mass_damping", "stiffness_damping", "relaxation_share", "relaxation_time")
    return _core.DynamicsOptions(scheme=scheme, step=step, **{name: motion[name] for name in keys})


def substeps(values: np.ndarray, count: int = SUBSTEPS) -> np.ndarray:
    """Values between frames, on straight lines: T x L -> ((T - 1) count + 1) x L."""
    values = np.asarray(values, dtype=np.float64)
    if values.ndim != 2 or len(values) < 2 or not np.isfinite(values).all():
        raise _core.InvalidInput(
            f"values are {values.shape}, needed are finite numbers for two frames or more"
        )
    at = np.arange((len(values) - 1) * count + 1) / count
    before = np.minimum(at.astype(int), len(values) - 2)
    share = (at - before)[:, None]
    return (1 - share) * values[before] + share * values[before + 1]
