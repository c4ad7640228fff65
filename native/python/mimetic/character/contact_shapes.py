# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact of a take as shapes with curves, which part lips and lids where they would overlap.

A performance's surface is a linear sum and has no contact. Its corrections over time lie close to a
few shapes; frames in which nothing touches have the value 0.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.shapes import CONTACT, Shape
from mimetic.muscles.contact import contact_on
from mimetic.performance.document import Performance
from mimetic.performance.gaze import seen_articulators
from mimetic.template.face_template import load_template

NAME = "contact."
Progress = Callable[[float, str], bool]


def contact_shapes(performance: Performance, progress: Progress | None = None) -> list[Shape]:
    """Shapes to add to those of a performance; none if nothing touches or the mesh is another's.

    Stopped by `progress`, they cover the frames so far.
    """
    template = load_template()
    if not np.array_equal(performance.faces, template.faces):
        return []
    try:
        contact = contact_on(performance.neutral_vertices)
    except InvalidInput:  # a head that the capture's own muscles do not fit: keyed as it is
        return []
    values, offsets = _core.contact_shapes(
        contact,
        _motion(performance, contact.vertices),
        None if progress is None else lambda fraction: progress(fraction, "contact"),
    )
    return _shapes(values, offsets, contact.moved, len(performance.neutral_vertices))


def shapes_of_corrections(
    corrections: Mapping[int, NDArray], num_frames: int, vertices: NDArray, num_vertices: int
) -> list[Shape]:
    """Few shapes whose sums are the corrections (frame index -> W x 3 metres of moved vertices)."""
    rows = np.array(list(corrections.values()), dtype=np.float64).reshape(-1, 3 * len(vertices))
    values, offsets = _core.shapes_of_corrections(rows, list(corrections), num_frames)
    return _shapes(values, offsets, vertices, num_vertices)


def _shapes(
    values: NDArray[np.float64], offsets: NDArray[np.float64], vertices: NDArray, num_vertices: int
) -> list[Shape]:
    """values: N x S; offsets: S x 3W, of the moved vertices (W) among all."""
    shapes = []
    for k, over_time in enumerate(values.T):
        whole = np.zeros((num_vertices, 3))
        whole[vertices] = offsets[k].reshape(-1, 3)
        shapes.append(Shape(f"{NAME}{k:03d}", CONTACT, whole, over_time.copy(), -1.0, 1.0))
    return shapes


def _motion(performance: Performance, vertices: NDArray[np.int32]) -> list[tuple]:
    """Values (N x M) of a performance's modes and these at vertices (M x 3K)."""
    parts = [
        (performance.activations, performance.muscle_modes),
        (seen_articulators(performance), performance.articulator_modes),
        (performance.detail_coefficients, performance.detail_modes),
    ]
    return [
        (values, modes[:, vertices].reshape(len(modes), -1))
        for values, modes in parts
        if values is not None and modes is not None
    ]
