# SPDX-License-Identifier: GPL-3.0-or-later
"""How deep lips and lids would lie in each other, and do after contact; what is before the teeth.

    python -m evaluation.anatomy.contact_table

All pairs of muscles, extras and whole expressions at full value, in millimetres. `teeth` is the
smallest distance, forwards, of the outer skin from the teeth behind it.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
from mimetic.muscles.anatomy import attach_skin, modes_of
from mimetic.muscles.contact import attach_contact
from mimetic.muscles.extras import attach_extras
from mimetic.skin.mesh import SkinMesh, multiply
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.anatomy.anatomy_sheet import anatomy_tiles, sheet_tiles

TEETH_FRONT = 0.02  # m behind the foremost tooth; molars have no lips before them


def before_teeth(mesh: SkinMesh, displacement: NDArray[np.float64]) -> float:
    """Smallest distance along z of the outer skin from the front teeth behind it, m."""
    template = mesh.template
    shape = mesh.vertices + multiply(mesh.stencils, displacement[: template.num_skin_vertices])
    faces = mesh.triangles[mesh.triangle_part == "skin"]
    teeth = template.part_vertices("teeth_upper", "teeth_lower")
    teeth = teeth[template.vertices[teeth, 2] > template.vertices[teeth, 2].max() - TEETH_FRONT]
    places = template.vertices[teeth] + displacement[teeth]
    around = np.abs(shape[faces].mean(axis=1) - places.mean(axis=0)).max(axis=1) < 0.05
    a, b, c = (shape[faces[around][:, k]] for k in range(3))
    outward = np.cross(b - a, c - a)[:, 2] > 0
    face, weights = faces_at(places[:, :2], *(p[outward][:, :2] for p in (a, b, c)))
    hit = face >= 0
    corners = shape[faces[around][outward][face[hit]], 2]
    return float(((weights[hit] * corners).sum(axis=1) - places[hit, 2]).min())


def faces_at(points, a, b, c) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """In the plane: which triangle holds each point (K; -1 for none), and its weights K x 3."""

    def doubled(p, q, r):
        return (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (
            r[..., 0] - p[..., 0]
        )

    point = points[:, None]
    whole = doubled(a, b, c)
    whole = np.where(np.abs(whole) < 1e-15, np.nan, whole)
    parts = [doubled(point, b, c), doubled(a, point, c), doubled(a, b, point)]
    weights = np.stack(parts, axis=-1) / whole[..., None]
    inside = (weights >= -1e-9).all(axis=-1)
    face = np.where(inside.any(axis=1), inside.argmax(axis=1), -1)
    return face, weights[np.arange(len(points)), np.maximum(face, 0)]


def main(arguments: list[str] | None = None) -> int:
    argparse.ArgumentParser(
        prog="evaluation.anatomy.contact_table", description=__doc__
    ).parse_args(arguments)
    template = load_template()
    skin = attach_skin(template.vertices, template)
    anatomy, contact = modes_of(skin), attach_contact(skin)
    shapes = {
        title: t.displacement for title, t in sheet_tiles(anatomy, attach_extras(skin)).items()
    }
    lids = anatomy_tiles(anatomy)
    shapes["all lids closed"] = lids["lid_upper"] + lids["lid_lower"]
    print(f"{'mm':40s} before   after   teeth")
    for title, shape in shapes.items():
        displacement = contact.relieve(shape)
        before, after = (1e3 * contact.depth(s) + 0.0 for s in (shape, displacement))
        print(
            f"{title:40s} {before:6.2f} {after:7.3f} "
            f"{1e3 * before_teeth(skin.mesh, displacement):7.1f}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
