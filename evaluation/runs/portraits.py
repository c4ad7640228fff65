# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of faces at rest whose head, pose and camera are known (docs/measured/fitting.md)."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from mimetic import InvalidInput
from mimetic.shared.array_file import read_archive
from mimetic.template.face_template import FaceTemplate
from numpy.typing import NDArray

from evaluation.runs.rendered import render

SHAPES: dict[str, tuple[int | str, ...]] = {
    "images": ("N", "H", "W", 3),
    "person": ("N",),
    "head_pose": ("N", 4, 4),
    "intrinsics": ("N", 3, 3),
    "yaw": ("N",),
    "pitch": ("N",),
    "neutral_vertices": ("P", "V", 3),
}
KINDS = {"images": "uint8", "person": "i"}  # others are float64
LARGEST = {"N": 20000, "H": 4096, "W": 4096, "P": 20000, "V": 100_000}


@dataclass(frozen=True)
class Portraits:
    """N pictures of P people whose heads have the canonical head's mesh."""

    images: NDArray[np.uint8]  # N x H x W x 3, RGB
    person: NDArray[np.int64]  # N, into neutral_vertices
    head_pose: NDArray[np.float64]  # N x 4 x 4, camera from head
    intrinsics: NDArray[np.float64]  # N x 3 x 3, pixels
    yaw: NDArray[np.float64]  # N, degrees
    pitch: NDArray[np.float64]  # N, degrees
    neutral_vertices: NDArray[np.float64]  # P x V x 3, metres, head frame

    @classmethod
    def load(cls, path: str | os.PathLike, template: FaceTemplate) -> Portraits:
        """Reads the file; raises InvalidInput, UnreadableMedia."""
        arrays = read_archive(path, SHAPES, KINDS, LARGEST)
        people, vertices = arrays["neutral_vertices"].shape[:2]
        if vertices != len(template.vertices):
            raise InvalidInput(
                f"{path}: the people have {vertices} vertices, the canonical head "
                f"{len(template.vertices)}"
            )
        if not ((arrays["person"] >= 0) & (arrays["person"] < people)).all():
            raise InvalidInput(f"{path}: person must be 0 to {people - 1}")
        return cls(**arrays)


def rendered_portraits(which: str, template: FaceTemplate, report=None) -> Portraits:
    """The portraits of a set, drawn now if the cache lacks them."""
    output = render(["--portraits", which], "the portraits could not be drawn", report)
    return Portraits.load(output.strip(), template)
