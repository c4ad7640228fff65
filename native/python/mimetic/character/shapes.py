# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance as named shapes with a curve each, the form that keyed characters carry."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic.character.gaze_shapes import gaze_kind, gaze_shapes, gaze_sliders
from mimetic.character.shape import Shape, shape_of_values
from mimetic.muscles.action_units import HIGHEST, unit_sides
from mimetic.muscles.anatomy import Anatomy
from mimetic.muscles.articulators import ARTICULATORS
from mimetic.muscles.extras import Extras, lip_rows
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE, seen_articulators
from mimetic.template.face_template import load_template

GROUPS = {
    1: "Lip Corners",
    2: "Upper Lip and Nose",
    3: "Lip Depressors",
    4: "Chin and Lip Ring",
    5: "Brow Raisers",
    6: "Brow Lowerers",
    7: "Eye Ring",
}
SIDES = ("", ".L", ".R")  # both, the subject's left, right
JAW_AND_LIDS = "Jaw and Lids"
DETAIL = "Detail"
CONTACT = "Contact"
ACTION_UNITS = "Action Units"


def group_name(group: int, side: str = "") -> str:
    """A group's slider: of one side (".L", ".R") or of both."""
    return GROUPS[group] + side


def shapes_of(performance: Performance) -> list[Shape]:
    """Muscles, articulators and detail of a performance, in this order.

    At every frame the neutral vertices plus the sum of value times offsets are
    `performance.surface(i)`; without detail, give `performance.without_detail()`.
    """
    shapes = [
        shape_of_values(name, GROUPS[int(group)], modes, values, 0.0)
        for name, group, modes, values in zip(
            performance.muscles,
            performance.groups,
            performance.muscle_modes,
            performance.activations.T,
            strict=True,
        )
    ]
    if performance.articulator_modes is not None:
        shapes += [
            shape_of_values(name, group, modes, values, lowest, highest)
            for (name, group, lowest, highest), modes, values in zip(
                map(listed, performance.articulators),
                performance.articulator_modes,
                seen_articulators(performance).T,
                strict=True,
            )
            if name not in GAZE
        ]
    shapes += gaze_shapes(performance)
    if performance.detail_modes is not None and performance.detail_coefficients is not None:
        shapes += [
            _detail(i, modes, values)
            for i, (modes, values) in enumerate(
                zip(performance.detail_modes, performance.detail_coefficients.T, strict=True)
            )
        ]
    return shapes


def listed(articulator: str) -> tuple[str, str, float, float]:
    """Its name, what it is listed under, and the range of its slider."""
    for row in lip_rows():
        if row["name"] == articulator:
            return articulator, row["group"], *row["limits"]
    return articulator, JAW_AND_LIDS, *ARTICULATORS.get(articulator, (-1.0, 1.0))


def slider_shapes_of(performance: Performance, sliders: Iterable[str] = ()) -> list[Shape]:
    """The same for a head with the muscles' sliders (`shapes_of_anatomy`, `shapes_of_extras`).

    Its eyes turn by the gaze's sliders, which move the lids, too; or by the shapes of
    `gaze_shapes` where they are among the head's, as of a face that was itself captured.
    """
    shapes = shapes_of(performance.without_detail())
    if gaze_kind(sliders) == "turns":
        return shapes
    names = [shape.name for shape in gaze_shapes(performance)]
    remaining_shapes = [shape for shape in shapes if shape.name not in names]
    return gaze_sliders(performance, remaining_shapes)


def groups_of(performance: Performance) -> list[Shape]:
    """The group sliders of a performance's face."""
    return group_shapes(performance.muscles, performance.groups, performance.muscle_modes)


def group_shapes(names: Sequence[str], groups: ArrayLike, modes: NDArray) -> list[Shape]:
    """Sliders of groups of muscles, left, right and both: sums of their muscles' shapes.

    names: M muscles; groups: M, 1 to 7; modes: M x V x 3. They have no values: what they do comes
    on top of the muscles' own curves, so that a whole take is softened (to -1) or strengthened.
    """
    groups = np.asarray(groups)
    shapes = []
    for group in GROUPS:
        for side in SIDES:
            is_member = (groups == group) & [name.endswith(side) for name in names]
            if is_member.any():
                offsets = np.asarray(modes)[is_member].sum(axis=0, dtype=np.float64)
                shapes.append(_slider(group_name(group, side), GROUPS[group], offsets, -1.0, 1.0))
    return shapes


def shapes_of_anatomy(anatomy: Anatomy) -> list[Shape]:
    """Muscles and articulators of a head at rest."""
    muscles = zip(anatomy.muscle_names, anatomy.groups, anatomy.muscle_modes, strict=True)
    articulators = zip(
        anatomy.articulator_names,
        anatomy.articulator_modes,
        anatomy.articulator_limits,
        strict=True,
    )
    return [
        *(_slider(name, GROUPS[int(group)], modes, 0.0, 1.0) for name, group, modes in muscles),
        *(_slider(name, JAW_AND_LIDS, modes, *limits) for name, modes, limits in articulators),
    ]


def shapes_of_extras(extras: Extras) -> list[Shape]:
    """Lips in parts, air and gaze: set by hand; no take moves them."""
    entries = zip(extras.names, extras.groups, extras.modes, extras.limits, strict=True)
    return [_slider(name, group, modes, *limits) for name, group, modes, limits in entries]


def shapes_of_units(neutral: NDArray[np.float64]) -> list[Shape]:
    """Action units of FACS on a canonical head's neutral vertices (V x 3): set by hand.

    Raises InvalidInput on another mesh.
    """
    modes = unit_sides(neutral, load_template())
    return [_slider(name, ACTION_UNITS, mode, 0.0, HIGHEST) for name, mode in modes.items()]


def _slider(name: str, group: str, offsets: NDArray, lowest: float, highest: float) -> Shape:
    """A shape that no take moves yet."""
    offsets = np.asarray(offsets, dtype=np.float64)
    return Shape(name, group, offsets, np.empty(0), float(lowest), float(highest))


def _detail(i: int, offsets: NDArray, values: NDArray[np.float64]) -> Shape:
    # Coefficients have any size; a slider's range is -1 to 1
    scale = float(np.abs(values).max()) or 1.0
    return shape_of_values(f"detail.{i:03d}", DETAIL, offsets * scale, values / scale, -1.0)
