# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles, jaw and lids attached to a person's neutral head: modes by finite elements.

`attach` gives the displacement of all control vertices for every muscle at activation 1 and every
articulator at value 1. Data: data/muscles.toml and data/materials.toml, with their sources.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache, cached_property
from importlib import resources

import numpy as np

from mimetic import _core
from mimetic.muscles.articulators import ARTICULATORS, JAW, EyeLids, Jaw, eye_frames
from mimetic.muscles.calibration import Calibration
from mimetic.skin.checks import check_areas, check_size
from mimetic.skin.mesh import LEVELS, Place, SkinMesh, find_place, keep_columns, multiply

SIDES = ("L", "R")
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

    muscle_names: 36, zygomaticus_major.L and so on; groups: 36, 1 to 7; muscle_modes: 36 x V x 3,
    displacement at activation 1; muscle_strengths: 36, newtons (sphincters: newtons a metre);
    articulator_names, articulator_modes A x V x 3 at value 1, articulator_limits A x 2.
    """

    muscle_names: tuple[str, ...]
    groups: np.ndarray
    muscle_modes: np.ndarray
    muscle_strengths: np.ndarray
    articulator_names: tuple[str, ...]
    articulator_modes: np.ndarray
    articulator_limits: np.ndarray


@cache
def load_table(name: str) -> dict:
    """A data file of the package."""
    return tomllib.loads((resources.files("mimetic") / "data" / name).read_text("utf-8"))


def muscle_table() -> list[dict]:
    """The 18 pairs, as in muscles.toml."""
    return load_table("muscles.toml")["muscle"]


def attach(
    neutral_vertices, template, *, perturbation: AnatomyPerturbation | None = None
) -> Anatomy:
    """Attach muscles, jaw and lids to a neutral head.

    neutral_vertices: V x 3, metres, head frame, the template's mesh; template: FaceTemplate.
    Raises InvalidInput on another mesh, NaN, a head that is not in metres, a skin with a hole, and
    a face without area. Faces that lie turned over are smoothed, with a warning that names them.
    """
    perturbation = perturbation or AnatomyPerturbation()
    return modes_of(attach_skin(neutral_vertices, template, perturbation), perturbation)


def attach_skin(
    neutral_vertices,
    template,
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
    _core.check_openings(mesh.triangles, 1, 2 * 4**LEVELS)
    check_areas(mesh.vertices, mesh.triangles, mesh.refinement.parent_face)
    factor = (perturbation or AnatomyPerturbation()).stiffness_factor
    return AttachedSkin(mesh, factor, calibration)


def modes_of(skin: AttachedSkin, perturbation: AnatomyPerturbation | None = None) -> Anatomy:
    """Muscles, jaw and lids on a skin that is attached; strengths as it was calibrated."""
    mesh = skin.mesh
    pulled = pull(skin, canonical_skin(mesh.template), perturbation)
    muscle_modes = skin.spread(pulled.responses * pulled.strengths[:, None, None])
    jaw = Jaw(mesh)
    jaw_modes = [skin.move_bone(jaw, name) for name in JAW]
    lid_modes = [lid for frame in eye_frames(mesh) for lid in EyeLids(frame).modes()]
    modes = dict(zip(ARTICULATORS, [*jaw_modes, *lid_modes], strict=True))
    return Anatomy(
        muscle_names=muscle_names(),
        groups=np.repeat([row["group"] for row in muscle_table()], 2).astype(np.int32),
        muscle_modes=muscle_modes,
        muscle_strengths=pulled.strengths,
        articulator_names=tuple(modes),
        articulator_modes=np.stack(list(modes.values())),
        articulator_limits=np.array(list(ARTICULATORS.values())),
    )


@dataclass(frozen=True)
class Pulled:
    """What the 36 muscles do to a skin.

    forces: 36 x N x 3 on the refined vertices at unit strength; responses: 36 x S x 3, metres, of
    the control vertices to them; strengths: 36, newtons (sphincters: newtons a metre).
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
    forces = np.stack([skin.mesh.surface.forces(muscle) for muscle in muscles])
    responses = skin.respond(forces)
    rows = [(row, side) for row in muscle_table() for side in SIDES]
    strengths = [
        strength(row, measured_place(canonical, row, side), skin.mesh, response)
        for (row, side), response in zip(rows, responses, strict=True)
    ]
    factors = skin.calibration.strength_factors(names)
    return Pulled(forces, responses, np.array(strengths) * factors)


def canonical_skin(template) -> SkinMesh:
    """The skin of the template itself, on which muscles have their places."""
    return SkinMesh(template, np.ascontiguousarray(template.vertices, dtype=np.float64))


def muscle_names() -> tuple[str, ...]:
    """The 36, left and right of each pair in turn."""
    return tuple(f"{row['name']}.{side}" for row in muscle_table() for side in SIDES)


def place_muscles(
    canonical: SkinMesh,
    mesh: SkinMesh,
    perturbation: AnatomyPerturbation,
    shifts_mm: np.ndarray | None = None,
) -> list[_core.Muscle]:
    """The 36 muscles on a person's skin, left and right of each pair in turn.

    shifts_mm: 36 x 2 of the insertions along the skin, away from the midline and up.
    """
    shifts_mm = np.zeros((2 * len(muscle_table()), 2)) if shifts_mm is None else shifts_mm
    random = np.random.default_rng(perturbation.seed)
    muscles = []
    for row in muscle_table():
        for side in SIDES:
            angle = random.uniform(0, 2 * np.pi)
            shift = perturbation.insertion_mm * np.array([np.cos(angle), np.sin(angle)])
            shift += shifts_mm[len(muscles)]
            muscles.append(place_muscle(canonical, mesh, row, side, shift))
    return muscles


def place_muscle(canonical: SkinMesh, mesh: SkinMesh, row: dict, side: str, shift) -> _core.Muscle:
    def find(place, side, shift=(0.0, 0.0)):
        anchor, x, y, depth = place
        return find_place(canonical, anchor, x + shift[0], y + shift[1], depth, side)

    def position(place, side, shift=(0.0, 0.0)):
        return find(place, side, shift).position(mesh)

    insertion = [position(place, side, shift) for place in row["insertion"]]
    scale = np.mean([find(place, side, shift).scale(mesh) for place in row["insertion"]])
    origin = np.zeros(3)
    if row["type"] == "sphincter":
        other = SIDES[1 - SIDES.index(side)]
        insertion.append(position(row["insertion"][0], other, shift))
    else:
        origin = position(row["origin"], side)
    return _core.Muscle(
        type=getattr(_core.MuscleType, row["type"]),
        insertion=np.array(insertion),
        origin=origin,
        width=1e-3 * row["width"] * scale,
        normal_share=row.get("normal_share", 0.1),
        protrusion=row.get("protrusion", 0.0),
        swelling=row.get("swelling", 0.0),
    )


def strength(row: dict, measured: Place, mesh: SkinMesh, response: np.ndarray) -> float:
    """That gives a muscle its excursion, in proportion to the person's local size.

    measured: its `measured_place`; response: S x 3 of the skin to the muscle at unit force.
    """
    moved = np.linalg.norm(measured.on_vertex(mesh, response))
    return 1e-3 * row["excursion_mm"] * measured.scale(mesh) / moved


def measured_place(canonical: SkinMesh, row: dict, side: str) -> Place:
    """The place on the skin by whose motion a muscle's strength is known."""
    anchor, x, y = row["measured_at"]
    return find_place(canonical, anchor, x, y, 0, side)


class AttachedSkin:
    """Skin with its materials on its bones, factored when first asked."""

    def __init__(
        self, mesh: SkinMesh, stiffness_factor: float, calibration: Calibration | None = None
    ):
        self.mesh = mesh
        self.calibration = calibration or Calibration()
        template = mesh.template
        self.free = self._free_vertices()
        self.basis = keep_columns(mesh.stencils, self.free)
        stiffness = stiffness_factor
        if self.calibration.stiffness:
            stiffness = stiffness * self.calibration.stiffness_factors(mesh)
        self.materials = self._materials(stiffness)
        self.num_vertices = len(template.vertices)

    @cached_property
    def model(self) -> _core.SkinModel:
        mesh = self.mesh
        return _core.SkinModel(
            mesh.vertices, mesh.triangles, self.materials, self.basis, int(self.free.sum())
        )

    def respond(self, forces: np.ndarray) -> np.ndarray:
        """M x N x 3 newtons -> displacements of the skin's control vertices, M x S x 3."""
        columns = forces.reshape(len(forces), -1).T
        solution = self.model.solve(columns).T.reshape(len(forces), -1, 3)
        response = np.zeros((len(forces), len(self.free), 3))
        response[:, self.free] = solution
        return response

    def spread(self, responses: np.ndarray) -> np.ndarray:
        """From the skin, M x S x 3, to the whole head, M x V x 3: lashes follow their lids."""
        modes = np.zeros((len(responses), self.num_vertices, 3))
        modes[:, : len(self.free)] = responses
        for frame in eye_frames(self.mesh):
            lashes, roots = frame.lash_roots
            modes[:, lashes] = responses[:, roots]
        return modes

    def move_bone(self, jaw: Jaw, name: str) -> np.ndarray:
        """Mode V x 3 of the jaw: the attachments' feet move with the bone, the skin follows."""
        forces = self.model.foundation_forces(jaw.under_skin(name))
        mode = self.spread(self.respond(forces[None]))[0]
        rigid = jaw.rigid_vertices
        mode[rigid] = jaw.motion(name, self.mesh.neutral[rigid])
        return mode

    def _free_vertices(self) -> np.ndarray:
        mesh = self.mesh
        count = int(mesh.template.num_skin_vertices)
        skin = mesh.neutral[:count]
        held = mesh.in_region("ear") | mesh.in_region("scalp")
        held |= mesh.in_region("neck") & (
            skin[:, 2] < mesh.neutral[mesh.landmark("gonion.L"), 2] - 0.06 * mesh.size
        )
        held |= skin[:, 1] < skin[:, 1].min() + 0.012 * mesh.size  # the lower edge of the neck
        depth = mesh.whole_surface.distances(
            mesh.vertices[mesh.vertices_between("skin", "eye_socket")], 0.008 * mesh.size
        )[:count]
        held |= mesh.in_region("eye_socket") & ~np.isfinite(depth)
        return ~held

    def _materials(self, stiffness_factor: float | np.ndarray) -> _core.SkinMaterials:
        mesh = self.mesh
        table = load_table("materials.toml")
        count = int(mesh.template.num_skin_vertices)
        values = {name: np.full(count, table["base"][name]) for name in MATERIALS}
        for region, factors in table["regions"].items():
            for name, factor in factors.items():
                values[name][mesh.in_region(region)] *= factor
        # Skin and fat are as thick as the face is long: a pull then spreads in proportion too.
        values["thickness"] *= mesh.local_scale
        values["tangential"] /= mesh.local_scale
        values["normal"] /= mesh.local_scale
        values = {name: multiply(mesh.stencils, value) for name, value in values.items()}
        lids = table["lid_margin"]
        margin = mesh.vertices[mesh.vertices_between("skin", "eye_socket")]
        reach = lids["reach"] * mesh.size
        distance = mesh.whole_surface.distances(margin, 2 * reach)
        nearness = np.clip(2 - distance / reach, 0, 1)
        for name in ("tangential", "normal"):
            values[name] *= lids["attachment"] ** nearness * stiffness_factor
        return _core.SkinMaterials(**values)
