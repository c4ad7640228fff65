# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of a face that have looks of their own: where they are, and what moves them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic.template.face_template import FaceTemplate

FACE = "face"
PARTS = ("brow.L", "brow.R", "eye.L", "eye.R", "mouth")
KINDS = (FACE, *PARTS)
BROW_GROUPS, EYE_GROUPS = (5, 6), (7,)  # of muscles, by their number
EYE_STEMS = ("lid", "gaze")  # of articulators

# From which landmarks to which a part reaches, and how far beyond them: metres to the left of the
# picture, right, up, down. Of sided parts `.S` is the side, the outer end the second landmark.
REACHES: dict[str, tuple[tuple[str, ...], tuple[float, float, float, float]]] = {
    FACE: (("zygion.L", "zygion.R", "brow_middle.L", "menton"), (-0.008, -0.008, 0.03, 0.004)),
    "brow": (("brow_inner.S", "brow_outer.S", "brow_middle.S"), (0.01, 0.01, 0.014, 0.008)),
    "eye": (
        ("eye_inner.S", "eye_outer.S", "lid_upper.S", "lid_lower.S"),
        (0.006, 0.006, 0.008, 0.016),
    ),
    "mouth": (
        ("mouth_corner.L", "mouth_corner.R", "nose_base", "lip_lower"),
        (0.013, 0.013, 0.01, 0.022),
    ),
}


def part_box(
    part: str, vertices: NDArray[np.float64], template: FaceTemplate
) -> tuple[float, float, float, float]:
    """Left, right, bottom, top of a part of a neutral face (V x 3), metres in the head frame."""
    stem, _, side = part.partition(".")
    names, (left, right, up, down) = REACHES[stem]
    places = vertices[[template.landmark(name.replace(".S", f".{side}")) for name in names], :2]
    low, high = places.min(axis=0), places.max(axis=0)
    return (
        float(low[0] - left),
        float(high[0] + right),
        float(low[1] - down),
        float(high[1] + up),
    )


def channels_of(
    part: str, muscles: Sequence[str], groups: Sequence[int], articulators: Sequence[str]
) -> list[int]:
    """Which of the muscles and articulators, one after the other, a part moves."""
    owners = [_owner_of_muscle(name, group) for name, group in zip(muscles, groups, strict=True)]
    owners += [_owner_of_articulator(name) for name in articulators]
    return [i for i, owner in enumerate(owners) if part in (FACE, owner)]


def _owner_of_muscle(name: str, group: int) -> str:
    side = name.rpartition(".")[2]
    if side in ("L", "R") and group in BROW_GROUPS:
        return f"brow.{side}"
    if side in ("L", "R") and group in EYE_GROUPS:
        return f"eye.{side}"
    return "mouth"


def _owner_of_articulator(name: str) -> str:
    stem, _, side = name.rpartition(".")
    return f"eye.{side}" if stem.split("_")[0] in EYE_STEMS else "mouth"
