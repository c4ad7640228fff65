# SPDX-License-Identifier: GPL-3.0-or-later
"""Spread length of a single pull on the face, against the theory of an endless flat sheet.

    python -m evaluation.anatomy.skin_spread [--length MM]

The face's mesh, stencils and solver, with one material everywhere, so that there is a theory: a
sheet with stretch stiffness E t / (1 - nu^2) on a foundation k spreads a pull over the length
sqrt(stretch / k). The length is read from the shape of the displacements alone, not their size.
"""

from __future__ import annotations

import argparse

import numpy as np
from mimetic import _core
from mimetic.muscles.anatomy import AttachedSkin
from mimetic.skin.mesh import SkinMesh, canonical_skin, find_place, multiply
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

YOUNG, POISSON, THICKNESS = 40e3, 0.45, 1.5e-3
STRETCH = YOUNG * THICKNESS / (1 - POISSON**2)  # N/m
SHEAR = YOUNG * THICKNESS / 2 / (1 + POISSON)
FOOTPRINT = 8e-3  # m, standard deviation of the pull, as of a muscle
REACH = 2.5  # lengths around the pull that are compared
# From a landmark, mm: away from the midline, up
PLACES = {
    "cheek": ("mouth_corner", 18, 22),
    "zygomatic": ("zygion", -12, -5),
    "masseter": ("gonion", -12, 25),
    "forehead": ("glabella", 25, 35),
    "chin": ("menton", 25, 20),
}


class EvenSkin(_core.AttachedSkin):
    """Skin on its bones that is the same everywhere and spreads pulls over one length."""

    def __init__(self, mesh: SkinMesh, length: float):
        self.mesh, self.length = mesh, length

        def everywhere(value):
            return np.full(len(mesh.vertices), value)

        materials = _core.SkinMaterials(
            young=everywhere(YOUNG),
            poisson=everywhere(POISSON),
            thickness=everywhere(THICKNESS),
            pre_stress=everywhere(0.0),
            tangential=everywhere(STRETCH / length**2),
            normal=everywhere(1e6),
        )
        free = AttachedSkin(mesh, 1.0).free
        super().__init__(mesh.vertices, mesh.triangles, materials, free, mesh.stencils)


class Patch:
    """The skin around a place, laid flat: along the pull and aside of it."""

    def __init__(self, mesh: SkinMesh, place: int, direction: NDArray[np.float64]):
        normal = mesh.normals[place]
        ahead = direction - normal * (normal @ direction)
        ahead /= np.linalg.norm(ahead)
        aside = np.cross(normal, ahead)
        outer = np.zeros(len(mesh.vertices), bool)
        outer[np.unique(mesh.triangles[mesh.triangle_part == "skin"])] = True
        self.near = outer & (mesh.normals @ normal > 0.3)  # no ear, no inside of the lips
        offset = mesh.vertices - mesh.vertices[place]
        # The arc over a chord, from the turn of the normal: skin is nearly round in places.
        half = np.arccos(np.clip(mesh.normals @ normal, -1, 1)) / 2 + 1e-9
        self.distance = np.linalg.norm(offset, axis=1) * np.minimum(half / np.sin(half), 1.3)
        flat = np.column_stack([offset @ ahead, offset @ aside])
        flat_distance = np.linalg.norm(flat, axis=1) + 1e-15
        self.flat = flat * (self.distance / flat_distance)[:, None]
        # The pull's direction at every vertex, turned with the skin
        sum_normal = mesh.normals + normal
        axis = (mesh.normals @ ahead) / np.maximum(1 + mesh.normals @ normal, 1e-9)
        self.direction = ahead - axis[:, None] * sum_normal
        self.areas = vertex_areas(mesh.vertices, mesh.triangles)

    def pull(self) -> NDArray[np.float64]:
        """N x 3 newtons, 1 N in all."""
        share = self.areas * np.exp(-((self.distance / FOOTPRINT) ** 2) / 2)
        share *= self.near & (self.distance < 4 * FOOTPRINT)
        return (share / share.sum())[:, None] * self.direction


def vertex_areas(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray:
    """A third of the triangles around each vertex, m^2."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(triangles.ravel(), np.repeat(third, 3), len(vertices))


def flat_theory(flat: NDArray[np.float64], length: float) -> NDArray[np.float64]:
    """Displacement along a pull of 1 N with the footprint, at places P x 2 of an endless sheet."""
    size, count = 0.3, 256
    wave = 2 * np.pi * np.fft.fftfreq(count, size / count)
    kx, ky = np.meshgrid(wave, wave, indexing="ij")
    k2 = kx**2 + ky**2
    along = np.divide(kx**2, k2, out=np.zeros_like(k2), where=k2 > 0)
    foundation = STRETCH / length**2
    response = along / (foundation + STRETCH * k2) + (1 - along) / (foundation + SHEAR * k2)
    load = np.exp(-k2 * FOOTPRINT**2 / 2) * (count / size) ** 2
    field = np.fft.fftshift(np.fft.ifft2(load * response).real)
    at = flat * count / size + count / 2
    corner = np.floor(at).astype(int)
    x, y = (at - corner).T
    i, j = corner.T
    low = (1 - y) * field[i, j] + y * field[i, j + 1]
    high = (1 - y) * field[i + 1, j] + y * field[i + 1, j + 1]
    return (1 - x) * low + x * high


def spread_length(skin: EvenSkin, place: int, direction: NDArray[np.float64]) -> float:
    """Length whose theory has the shape of the displacements around a pull, m.

    place: refined vertex; direction: of the pull, taken along the skin.
    """
    patch = Patch(skin.mesh, place, direction)
    response = multiply(skin.mesh.stencils, skin.respond(patch.pull()[None])[0])
    along_pull = (response * patch.direction).sum(1)
    is_near = patch.near & (patch.distance < REACH * skin.length)
    along_pull, weights = along_pull[is_near], patch.areas[is_near]
    flat = patch.flat[is_near]

    def misfit(log_length):
        theory = flat_theory(flat, np.exp(log_length))
        alike = (theory * along_pull * weights).sum() ** 2 / (theory**2 * weights).sum()
        return (along_pull**2 * weights).sum() - alike

    log_lengths = np.log(skin.length) + np.linspace(-0.7, 0.7, 29)
    misfits = [misfit(one) for one in log_lengths]
    best = int(np.clip(np.argmin(misfits), 1, len(log_lengths) - 2))
    a, b, _ = np.polyfit(log_lengths[best - 1 : best + 2], misfits[best - 1 : best + 2], 2)
    return float(np.exp(-b / (2 * a)))


def measure(length: float) -> dict[str, tuple[float, float]]:
    """Spread lengths at each place on the canonical head, m: of a pull sideways and of one up."""
    template = load_template()
    mesh = canonical_skin(template)
    skin = EvenSkin(mesh, length)
    result = {}
    for name, (anchor, x, y) in PLACES.items():
        place = find_place(mesh, anchor, x, y, 0, "L").vertex
        sideways, up = (spread_length(skin, place, axis) for axis in np.eye(3)[:2])
        result[name] = sideways, up
    return result


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="evaluation.anatomy.skin_spread", description=__doc__.split("\n")[0]
    )
    parser.add_argument("--length", type=float, default=12.5, help="spread length, mm (12.5)")
    length = 1e-3 * parser.parse_args().length
    print(
        "| place | pulled | spread length, mm | theory | error |\n| --- | --- | --- | --- | --- |"
    )
    for name, spread in measure(length).items():
        for axis, value in zip(("sideways", "up"), spread, strict=True):
            error = 100 * (value / length - 1)
            print(f"| {name} | {axis} | {1e3 * value:.2f} | {1e3 * length:g} | {error:+.1f} % |")


if __name__ == "__main__":
    main()
