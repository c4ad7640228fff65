# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact of a take as shapes with curves: what parts lips and lids where they would overlap.

A performance's surface is a linear sum and has no contact. Its corrections over time lie close to a
few shapes; frames in which nothing touches have the value 0.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.character.shapes import CONTACT, Shape
from mimetic.muscles.contact import Contact, contact_on
from mimetic.performance.document import Performance
from mimetic.template.face_template import load_template

TOLERANCE = 5e-5  # m, of the shapes' sum against the correction of each frame
MAX_SHAPES = 12
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
    corrections = {}
    for i, displacement in enumerate(_displacements(performance, contact)):
        if progress and i % 50 == 0 and not progress(i / performance.num_frames, "contact"):
            break
        correction = contact.correction(displacement)
        if correction is not None:
            corrections[i] = correction
    return shapes_of_corrections(
        corrections, performance.num_frames, contact.moved, len(performance.neutral_vertices)
    )


def _displacements(performance: Performance, contact: Contact):
    """Of the contact's vertices, K x 3 a frame."""
    parts = [(performance.activations, performance.muscle_modes)]
    if performance.articulator_modes is not None:
        parts.append((performance.articulator_values, performance.articulator_modes))
    if performance.detail_modes is not None and performance.detail_coefficients is not None:
        parts.append((performance.detail_coefficients, performance.detail_modes))
    parts = [
        (values, modes[:, contact.vertices].reshape(len(modes), -1)) for values, modes in parts
    ]
    for i in range(performance.num_frames):
        yield sum(values[i] @ modes for values, modes in parts).reshape(-1, 3)


def shapes_of_corrections(
    corrections: dict[int, NDArray], num_frames: int, moved: NDArray[np.int64], num_vertices: int
) -> list[Shape]:
    """Few shapes whose sums are the corrections (frame index -> W x 3 of the moved vertices)."""
    if not corrections:
        return []
    rows = np.stack([c.reshape(-1) for c in corrections.values()]).astype(np.float64)
    left, singular, right = np.linalg.svd(rows, full_matrices=False)
    count, rest = 0, rows
    while count < min(MAX_SHAPES, len(singular)) and np.abs(rest).max() > TOLERANCE:
        rest = rest - singular[count] * np.outer(left[:, count], right[count])
        count += 1
    shapes = []
    for k in range(count):
        values = np.zeros(num_frames)
        values[list(corrections)] = left[:, k] * singular[k]
        largest = np.abs(values).max()
        offsets = np.zeros((num_vertices, 3))
        offsets[moved] = right[k].reshape(-1, 3) * largest
        shapes.append(Shape(f"{NAME}{k:03d}", CONTACT, offsets, values / largest, -1.0, 1.0))
    return shapes
