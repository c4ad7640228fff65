# SPDX-License-Identifier: GPL-3.0-or-later
"""A face as values of ARKit's 52 units: the one map behind tables, files and what is sent live.

What bone moves is fitted by the jaw's units, what skin does by all others: a jaw that opens takes
the lower lip along, and would else be mended by units that push that lip about. Eyes and lids that
close are taken as they are: units of looks are their degrees, a lid that is shut is a full blink.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.gaze_shapes import look_values
from mimetic.character.shape import Shape
from mimetic.muscles.anatomy import load_table
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, SIDES
from mimetic.template.face_template import load_template

WORDS = {"L": "Left", "R": "Right"}
GROUP = "ARKit"  # what curves of the units are listed under
BONE = "jaw"  # how names of units and of articulators begin that bone moves
EYES = ("eyeLook", "eyeBlink")  # how names of units begin that are not fitted
BEYOND = 1.5  # a unit's highest value in the fit; cut at 1 then, so that no other takes the rest
NOT_CANONICAL = "the performance is not of the canonical head: capture the clip again"

Floats = NDArray[np.float64]


@cache
def unit_order() -> tuple[str, ...]:
    """The 52, in Live Link Face's order."""
    return tuple(load_table("arkit_shapes.toml")["order"])


class UnitFit:
    """Values of muscles, jaw, lids, lips and gaze as values of the units.

    names: of S values, gaze among them or not; modes: M x V x 3, metres at value 1, of those that
    are no gaze, in their order, on a canonical mesh at rest (points, V x 3); ranges: M x 2. Raises
    InvalidInput for another mesh.
    """

    def __init__(
        self, names: Sequence[str], points: Floats, modes: NDArray, ranges: Floats
    ) -> None:
        template = load_template()
        if np.shape(points) != template.vertices.shape:
            raise InvalidInput(NOT_CANONICAL)
        self._column = {name: i for i, name in enumerate(names)}
        faces = np.asarray(template.faces)
        starts = np.arange(0, faces.size, faces.shape[1]).tolist()
        areas = _core.polygon_areas(np.ascontiguousarray(points), starts, faces.ravel().tolist())
        moving = [name for name in names if name not in GAZE]
        self._parts = []
        for is_bone in (True, False):
            units = [
                unit
                for unit in unit_order()
                if unit.startswith(BONE) == is_bone and not unit.startswith(EYES)
            ]
            sources = [i for i, name in enumerate(moving) if name.startswith(BONE) == is_bone]
            rows = [template.unit_names.index(unit) for unit in units]
            fit = _core.ControlFit(
                np.asarray(template.unit_modes, dtype=np.float64)[rows],
                np.ascontiguousarray(np.asarray(modes)[sources], dtype=np.float64),
                areas,
                np.tile([0.0, BEYOND], (len(units), 1)),
                np.asarray(ranges, dtype=np.float64)[sources],
                _core.ControlFitOptions(),
            )
            columns = [self._column[moving[i]] for i in sources]
            self._parts.append(([unit_order().index(unit) for unit in units], columns, fit))

    def weights(self, values: Floats) -> Floats:
        """T x 52 from 0 to 1, in the order of `unit_order`. values: T x S, gaze in degrees."""
        units = np.zeros((len(values), len(unit_order())))
        skin = values.copy()
        for side in SIDES:
            for unit, weights in self._eye(values, side).items():
                units[:, unit_order().index(unit)] = weights
            if (lid := self._column.get(f"lid_upper.{side}")) is not None:
                skin[:, lid] = np.minimum(skin[:, lid], 0.0)  # what closes it is the blink's
        for rows, columns, fit in self._parts:
            expected = np.zeros((len(values), len(rows)))
            units[:, rows] = fit.frames(np.ascontiguousarray(skin[:, columns]), expected)
        return np.clip(units, 0.0, 1.0)

    def _eye(self, values: Floats, side: str) -> dict[str, Floats]:
        """T values of each unit of an eye that is not fitted."""
        weights = {}
        if (lid := self._column.get(f"lid_upper.{side}")) is not None:
            weights[f"eyeBlink{WORDS[side]}"] = values[:, lid]
        if all(name in self._column for name in GAZE):
            yaw, pitch = (
                values[:, self._column[f"gaze_{axis}.{side}"]] for axis in ("yaw", "pitch")
            )
            for look, amounts in look_values(side, yaw, pitch).items():
                way = look.removeprefix("look_").removesuffix(f".{side}")
                weights[f"eyeLook{way.title()}{WORDS[side]}"] = amounts
        return weights


def unit_values(performance: Performance) -> Floats:
    """T x 52: a performance as values of the units, on the performer's own mesh.

    Raises InvalidInput for a performance that is not of the canonical mesh.
    """
    names, modes = list(performance.muscles), list(performance.muscle_modes)
    values = performance.activations
    if performance.articulator_modes is not None:
        names += performance.articulators
        values = np.hstack([values, performance.articulator_values])
        modes += [
            mode
            for name, mode in zip(
                performance.articulators, performance.articulator_modes, strict=True
            )
            if name not in GAZE
        ]
    is_moving = [name not in GAZE for name in names]
    lowest, highest = np.minimum(values.min(axis=0), -1.0), np.maximum(values.max(axis=0), 1.0)
    lowest[: len(performance.muscles)] = 0.0
    ranges = np.stack([lowest, highest], axis=1)[is_moving]
    return UnitFit(names, performance.neutral_vertices, np.stack(modes), ranges).weights(values)


def unit_shapes(performance: Performance) -> list[Shape]:
    """The units as shapes with curves, for a face of the performer's own mesh.

    Raises InvalidInput for a performance that is not of the canonical mesh.
    """
    template = load_template()
    return [
        Shape(
            *(name, GROUP, np.asarray(template.unit_modes[template.unit_names.index(name)], float)),
            *(values, 0.0, 1.0),
        )
        for name, values in zip(unit_order(), unit_values(performance).T, strict=True)
    ]
