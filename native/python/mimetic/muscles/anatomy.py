# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles, jaw and lids attached to a person's neutral head: modes by finite elements.

`attach` gives the displacement of all control vertices for every muscle at activation 1 and every
articulator at value 1. Data: data/muscles.toml and data/materials.toml, with their sources.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib import resources

import numpy as np
from numpy.typing import ArrayLike

from mimetic import _core
from mimetic.muscles.articulators import ARTICULATORS, Jaw
from mimetic.muscles.calibration import Calibration
from mimetic.shared.progress import Progress
from mimetic.skin.checks import check_size
from mimetic.skin.mesh import SkinMesh, canonical_skin
from mimetic.template.face_template import FaceTemplate

SIDES = ("L", "R")
REFINED, FACTORED = 0.2, 0.85  # of what attaching costs: `scripts/bench_attach`
MATERIALS = ("young", "poisson", "thickness", "pre_stress", "tangential", "normal")


@dataclass(frozen=True)
class AnatomyPerturbation:
    """Another person's anatomy for the same face: truth that the estimator does not know.

    insertion_mm: length of each insertion's shift along the skin, in a random direction;
    stiffness_factor: times the attachment to the bone; seed: of the random directions.
    """

    insertion_mm: float = 0.0
    stiffness_factor: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.insertion_mm <= 20:
            raise _core.InvalidInput(f"insertion_mm is {self.insertion_mm}, allowed are 0 to 20")
        if not 0.01 <= self.stiffness_factor <= 100:
            raise _core.InvalidInput(
                f"stiffness_factor is {self.stiffness_factor}, allowed are 0.01 to 100"
            )


@dataclass(frozen=True)
class Anatomy:
    """Modes over the whole control mesh; metres, head frame.

    muscle_names: M, zygomaticus_major.L and so on; groups: M, 1 to 7; muscle_modes: M x V x 3,
    displacement at activation 1; muscle_strengths: M, newtons (sphincters: newtons a metre);
    articulator_names, articulator_modes A x V x 3 at value 1, articulator_limits A x 2; extent: M
    or 1, times the assumed displacement that muscle_modes go.
    """

    muscle_names: tuple[str, ...]
    groups: np.ndarray
    muscle_modes: np.ndarray
    muscle_strengths: np.ndarray
    articulator_names: tuple[str, ...]
    articulator_modes: np.ndarray
    articulator_limits: np.ndarray
    extent: np.ndarray | float = 1.0

    def extended_by(self, calibration: Calibration) -> Anatomy:
        """With activation 1 as this person's full contraction, by `Calibration.extent`."""
        extent = calibration.extent_factors(self.muscle_names)
        return replace(self, muscle_modes=self.muscle_modes * extent[:, None, None], extent=extent)


@cache
def load_table(name: str) -> dict:
    """A data file of the package."""
    return tomllib.loads((resources.files("mimetic") / "data" / name).read_text("utf-8"))


def muscle_table() -> list[dict]:
    """The pairs, as in muscles.toml."""
    return load_table("muscles.toml")["muscle"]


def muscle_entries() -> list[_core.MuscleEntry]:
    """The same for the core."""
    return [_entry(row) for row in muscle_table()]


def _entry(row: dict) -> _core.MuscleEntry:
    place = _core.LandmarkPlace
    return _core.MuscleEntry(
        name=row["name"],
        type=getattr(_core.MuscleType, row["type"]),
        insertion=[place(*at) for at in row["insertion"]],
        origin=place(*row["origin"]) if "origin" in row else place(row["insertion"][0][0], 0, 0),
        width=row["width"],
        normal_share=row.get("normal_share", 0.1),
        protrusion=row.get("protrusion", 0.0),
        swelling=row.get("swelling", 0.0),
        measured_at=place(*row["measured_at"]),
        excursion=row["excursion_mm"],
    )


@cache
def material_table(regions: tuple[str, ...] | None = None) -> _core.MaterialTable:
    """data/materials.toml for the core; regions: with factors of their own, by default all."""
    table = load_table("materials.toml")
    return _core.MaterialTable(
        base=[table["base"][name] for name in MATERIALS],
        regions={
            region: [factors.get(name, 1.0) for name in MATERIALS]
            for region, factors in table["regions"].items()
            if regions is None or region in regions
        },
        lid_reach=table["lid_margin"]["reach"],
        lid_attachment=table["lid_margin"]["attachment"],
    )


def attach(
    neutral_vertices: ArrayLike,
    template: FaceTemplate,
    *,
    perturbation: AnatomyPerturbation | None = None,
) -> Anatomy:
    """Attach muscles, jaw and lids to a neutral head.

    neutral_vertices: V x 3, metres, head frame, the template's mesh; template: FaceTemplate.
    Raises InvalidInput on another mesh, NaN, a head that is not in metres, a skin with a hole, and
    a face without area. Faces that lie turned over are smoothed, with a warning that names them.
    """
    perturbation = perturbation or AnatomyPerturbation()
    return modes_of(attach_skin(neutral_vertices, template, perturbation), perturbation)


def attach_skin(
    neutral_vertices: ArrayLike,
    template: FaceTemplate,
    perturbation: AnatomyPerturbation | None = None,
    calibration: Calibration | None = None,
) -> AttachedSkin:
    """A head's skin on its bones, checked; arguments and errors of `attach`.

    calibration: what is known of this person's skin and muscles.
    """
    neutral = np.ascontiguousarray(neutral_vertices, dtype=np.float64)
    if neutral.shape != np.shape(template.vertices):
        raise _core.InvalidInput(
            f"neutral_vertices are {neutral.shape}, needed are {np.shape(template.vertices)}"
        )
    if not np.isfinite(neutral).all():
        raise _core.InvalidInput("neutral_vertices hold NaN or infinity")
    check_size(neutral, template)
    mesh = SkinMesh(template, neutral)
    faces = np.repeat(mesh.refinement.parent_face, 2)
    _core.check_openings(mesh.triangles, 1, len(faces) // len(mesh.faces))
    _core.check_areas(mesh.vertices, mesh.triangles, faces)
    factor = (perturbation or AnatomyPerturbation()).stiffness_factor
    return AttachedSkin(mesh, factor, calibration)


def factored_skin(
    neutral_vertices: ArrayLike,
    template: FaceTemplate,
    calibration: Calibration | None = None,
    progress: Progress | None = None,
) -> AttachedSkin | None:
    """`attach_skin` with the stiffness factored, most of what attaching costs.

    progress: of attaching; None is returned where it says to stop.
    """
    skin = refined_skin(neutral_vertices, template, calibration, progress)
    if skin is None:
        return None
    skin.factor()
    return skin if progress is None or progress(FACTORED, "attaching the muscles") else None


def refined_skin(
    neutral_vertices: ArrayLike,
    template: FaceTemplate,
    calibration: Calibration | None = None,
    progress: Progress | None = None,
) -> AttachedSkin | None:
    """`factored_skin` without the factor, which is made where it is needed first."""
    if progress is not None and not progress(0.0, "refining the skin"):
        return None
    skin = attach_skin(neutral_vertices, template, calibration=calibration)
    goes_on = progress is None or progress(REFINED, "factoring the skin's stiffness")
    return skin if goes_on else None


def modes_of(skin: AttachedSkin, perturbation: AnatomyPerturbation | None = None) -> Anatomy:
    """Muscles, jaw and lids on a skin that is attached; strengths as it was calibrated."""
    mesh = skin.mesh
    pulls = pull(skin, canonical_skin(mesh.template), perturbation)
    jaw = Jaw(mesh)
    jaw_modes = _core.jaw_modes(skin, jaw, _core.HeadOnJaw.of(mesh, jaw))
    bones = [*jaw_modes, *_core.lid_modes(mesh)]
    modes = dict(zip(ARTICULATORS, bones, strict=True))
    return Anatomy(
        muscle_names=muscle_names(),
        groups=muscle_groups(),
        muscle_modes=skin.spread(pulls.responses * pulls.strengths[:, None, None]),
        muscle_strengths=pulls.strengths,
        articulator_names=tuple(modes),
        articulator_modes=np.stack(list(modes.values())),
        articulator_limits=np.array(list(ARTICULATORS.values())),
    )


@dataclass(frozen=True)
class Pulled:
    """What the muscles do to a skin.

    forces: M x N x 3 on the refined vertices at unit strength; responses: M x S x 3, metres, of
    the control vertices to them; strengths: M, newtons (sphincters: newtons a metre).
    """

    forces: np.ndarray
    responses: np.ndarray
    strengths: np.ndarray


def pull(
    skin: AttachedSkin, canonical: SkinMesh, perturbation: AnatomyPerturbation | None = None
) -> Pulled:
    """All muscles on a skin, placed and as strong as its calibration has them.

    canonical: `canonical_skin` of its template.
    """
    names = muscle_names()
    shifts = skin.calibration.insertion_shifts(names)
    perturbation = perturbation or AnatomyPerturbation()
    muscles = place_muscles(canonical, skin.mesh, perturbation, shifts)
    pulls = _core.pull_person(skin, skin.mesh, muscles)
    factors = skin.calibration.strength_factors(names)
    return Pulled(pulls.forces, pulls.responses, pulls.strengths * factors)


def muscle_names() -> tuple[str, ...]:
    """Left and right of each pair in turn."""
    return tuple(f"{row['name']}.{side}" for row in muscle_table() for side in SIDES)


def muscle_groups() -> np.ndarray:
    """The group of each, 1 to 7."""
    return np.repeat([row["group"] for row in muscle_table()], 2).astype(np.int32)


def place_muscles(
    canonical: SkinMesh,
    mesh: SkinMesh,
    perturbation: AnatomyPerturbation,
    shifts_mm: np.ndarray | None = None,
) -> list[_core.PlacedMuscle]:
    """The muscles on a person's skin, left and right of each pair in turn.

    shifts_mm: M x 2 of the insertions along the skin, away from the midline and up.
    """
    entries = muscle_entries()
    angles = np.random.default_rng(perturbation.seed).uniform(0, 2 * np.pi, 2 * len(entries))
    shifts = perturbation.insertion_mm * np.column_stack([np.cos(angles), np.sin(angles)])
    if shifts_mm is not None:
        shifts = shifts + shifts_mm
    return _core.place_muscles(canonical, mesh, entries, shifts)


class AttachedSkin(_core.AttachedSkin):
    """A person's skin with its materials on its bones, factored on first use."""

    def __init__(
        self,
        mesh: SkinMesh,
        stiffness_factor: float,
        calibration: Calibration | None = None,
        regions: tuple[str, ...] | None = None,
    ):
        """regions: whose materials differ from the base's, by default all that are in the table."""
        self.mesh = mesh
        self.calibration = calibration or Calibration()
        stiffness = np.full(len(mesh.vertices), float(stiffness_factor))
        if self.calibration.stiffness:
            stiffness = stiffness * self.calibration.stiffness_factors(mesh)
        super().__init__(mesh, material_table(regions), stiffness)
        self.num_vertices = len(mesh.template.vertices)

    def factor(self) -> None:
        """At once, not on first use. Raises InvalidInput on a skin that nothing holds."""
        _ = self.model

    @cached_property
    def moves_with(self) -> np.ndarray:
        """V: the skin's vertex that each of the head's goes with, -1 for none."""
        return _core.followed_vertices(self.mesh)

    def spread(self, responses: np.ndarray) -> np.ndarray:
        """From the skin, M x S x 3, to the whole head, M x V x 3: lashes follow their lids."""
        return _core.spread(responses, self.moves_with)
