# SPDX-License-Identifier: GPL-3.0-or-later
"""How far each muscle moves the face at full activation, beside what is published.

    python -m evaluation.anatomy.excursions

One row a pair: the place at which it is measured goes so far (left side: outwards, up, forwards),
so different on the two sides; the largest motion anywhere; the published range, where there is one.
Below: what several muscles do together, which is what published figures are of.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass

import numpy as np
from mimetic.muscles.anatomy import SIDES, Anatomy, attach, canonical_skin, muscle_table
from mimetic.skin.mesh import SkinMesh, find_place, multiply
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

FRONTALIS = ("frontalis_medial", "frontalis_middle", "frontalis_lateral")
SMILE = "mouth corner 11-14 mm, Flynn et al."
BROW = "brow 8-12 mm"
# Several muscles of both sides at 1, where they are measured, and the published range in mm
TOGETHER = (
    ("smile", ("zygomaticus_major",), ("mouth_corner", 0, 0), (11, 14), SMILE),
    ("smile, hearty", ("zygomaticus_major", "orbicularis_oculi_inferior"), ("mouth_corner", 0, 0),
     (11, 14), SMILE),
    ("brow raise, inner", FRONTALIS, ("brow_inner", 0, 0), (8, 12), BROW),
    ("brow raise, middle", FRONTALIS, ("brow_middle", 0, 0), (8, 12), BROW),
    ("brow raise, outer third", FRONTALIS, ("brow_outer", -6, 2), (8, 12), BROW),
    # The tail lies beyond the muscle's edge, the temporal line; published is the brow
    ("brow raise, tail", FRONTALIS, ("brow_outer", 0, 0), None, "-"),
)  # fmt: skip


@dataclass(frozen=True)
class Excursion:
    """Millimetres; motion: 3, of the left place: outwards, up, forwards."""

    name: str
    motion: NDArray[np.float64]
    difference: float  # right place less the left one's mirror image
    largest: float
    published: tuple[float, float] | None
    source: str

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.motion))

    @property
    def inside(self) -> bool:
        return self.published is None or self.published[0] <= self.length <= self.published[1]


def excursions(mesh: SkinMesh, anatomy: Anatomy) -> list[Excursion]:
    """Pairs of muscles one side at a time, then several together; mesh: the canonical head's."""
    modes = dict(zip(anatomy.muscle_names, anatomy.muscle_modes, strict=True))
    rows = []
    for row in muscle_table():
        sides = [modes[f"{row['name']}.{side}"] for side in SIDES]
        published_range = tuple(row["published_mm"]) if "published_mm" in row else None
        rows.append(
            _measure(mesh, row["name"], sides, row["measured_at"], published_range, row["source"])
        )
    for title, names, place, published_range, source in TOGETHER:
        whole = sum(modes[f"{name}.{side}"] for name in names for side in SIDES)
        rows.append(_measure(mesh, title, [whole, whole], place, published_range, source))
    return rows


def _measure(mesh, name, sides, place, published_range, source) -> Excursion:
    count = int(mesh.template.num_skin_vertices)
    anchor, x, y = place
    displacements = [multiply(mesh.stencils, mode[:count]) for mode in sides]
    left, right = (
        1e3 * motion[find_place(mesh, anchor, x, y, 0, side).vertex]
        for motion, side in zip(displacements, SIDES, strict=True)
    )
    difference = float(np.linalg.norm(right * [-1, 1, 1] - left))
    largest = float(1e3 * np.linalg.norm(displacements[0], axis=1).max())
    return Excursion(name, left, difference, largest, published_range, source)


def main(arguments: list[str] | None = None) -> int:
    argparse.ArgumentParser(prog="evaluation.anatomy.excursions", description=__doc__).parse_args(
        arguments
    )
    template = load_template()
    mesh = canonical_skin(template)
    rows = excursions(mesh, attach(template.vertices, template))
    print(f"{'mm':38s}  moves   out    up   fwd   L/R  largest  published")
    for row in rows:
        range_text = "{:g}-{:g}".format(*row.published) if row.published else "-"
        mark = "" if row.inside else "  OUTSIDE"
        motion = " ".join(f"{value:5.1f}" for value in row.motion)
        print(
            f"{row.name:38s}  {row.length:5.1f} {motion} {row.difference:5.2f} {row.largest:8.1f}"
            f"  {range_text:6s} {row.source}{mark}"
        )
    return 0 if all(row.inside for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
