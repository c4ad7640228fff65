# SPDX-License-Identifier: GPL-3.0-or-later
"""Still images of which it is known where the face is, or that there is none."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
from mimetic import InvalidInput
from mimetic.shared.array_file import read_archive
from numpy.typing import NDArray

from evaluation.runs.rendered import render

PARTS = ("pupil.L", "pupil.R", "nose", "mouth")
SHAPES: dict[str, tuple[int | str, ...]] = {
    "images": ("N", "H", "W", 3),
    "has_face": ("N",),
    "places": ("N", len(PARTS), 2),
    "ipd": ("N",),
    "yaw": ("N",),
    "kinds": ("N",),
    "parts": (len(PARTS),),
}
KINDS = {"images": "uint8", "has_face": "b", "kinds": "U", "parts": "U"}  # others are float64
LARGEST = {"N": 20000, "H": 4096, "W": 4096}


@dataclass(frozen=True)
class Stills:
    """N images; where there is no face, places, ipd and yaw are nan."""

    images: NDArray[np.uint8]  # N x H x W x 3, RGB
    has_face: NDArray[np.bool_]  # N
    places: NDArray[np.float64]  # N x PARTS x 2, pixels
    ipd: NDArray[np.float64]  # N, pixels between the pupils were the face frontal
    yaw: NDArray[np.float64]  # N, degrees
    kinds: list[str]  # N, what the image shows

    @classmethod
    def load(cls, path: str | os.PathLike) -> Stills:
        """Reads docs/measured/finding-faces.md's file; raises InvalidInput, UnreadableMedia."""
        arrays = read_archive(path, SHAPES, KINDS, LARGEST)
        if tuple(arrays.pop("parts").tolist()) != PARTS:
            raise InvalidInput(f"{path}: parts must be {', '.join(PARTS)}")
        has_places = np.isfinite(arrays["places"]).all((1, 2)) & (arrays["ipd"] > 0)
        if not has_places[arrays["has_face"]].all():
            raise InvalidInput(f"{path}: a face lacks its places or its ipd")
        return cls(**arrays | {"kinds": arrays["kinds"].tolist()})


def rendered_stills(which: str, report=None) -> Stills:
    """The images of a set, drawn now if the cache lacks them."""
    output = render(["--stills", which], "the images could not be drawn", report)
    return Stills.load(output.strip())
