# SPDX-License-Identifier: GPL-3.0-or-later
"""Windows of flattened contrast cut from pictures: faces, parts, and what lies beside them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from mimetic import _core

from .people import PX_PER_IPD
from .pictures import Pictures
from .scenes import mirrored, photographed, spectacled

FACE_IPDS = 2.0  # width of the face's window: temple to temple, brows to under the mouth
FACE_SIDE = 24
MODULE_IPD_PX = 20.0
MODULES = {  # window width in interpupillary distances, window size
    "pupil.L": (0.8, (16, 12)),
    "pupil.R": (0.8, (16, 12)),
    "nose": (0.9, (18, 14)),
    "mouth": (1.1, (22, 14)),
}
FACES_A_PICTURE = 2  # cut at other places each
OTHERS_A_PICTURE = 2
GLASSES = 0.12  # part of the people


@dataclass
class Windows:
    """Rows of float32 values a window."""

    faces: list = field(default_factory=list)
    yaws: list = field(default_factory=list)  # degrees, one a face
    beside: list = field(default_factory=list)  # at the wrong place or of the wrong size
    places: list = field(default_factory=list)  # 4 x 2 a picture, from the middle, in widths
    place_yaws: list = field(default_factory=list)  # degrees, one a picture
    modules: dict = field(default_factory=lambda: {name: [] for name in MODULES})
    beside_modules: dict = field(default_factory=lambda: {name: [] for name in MODULES})


def middle_of(places: np.ndarray) -> np.ndarray:
    """Half way from the eyes to the mouth: the middle of the face's window."""
    return (places[:2].mean(0) + places[3]) / 2


def windows_of(pictures: Pictures, rng: np.random.Generator) -> Windows:
    """Every front picture's windows, photographed anew, half of them mirrored."""
    windows = Windows()
    for i in pictures.fronts:
        grey, places, yaw = pictures.grey[i], pictures.places[i], pictures.yaw[i]
        if rng.random() < GLASSES:
            grey = spectacled(grey, places, rng)
        grey = photographed(grey, rng)
        if rng.random() < 0.5:
            (grey, places), yaw = mirrored(grey, places), -yaw
        _cut_faces(windows, grey, places, yaw, rng)
        _cut_parts(windows, grey, places, yaw, rng)
    return windows


def _face_window(grey, center, width, roll) -> np.ndarray:
    window = _core.flat_window(
        grey, center, width, roll, FACE_SIDE, FACE_SIDE, FACE_SIDE / FACE_IPDS
    )
    return window.ravel().astype(np.float32)


def _cut_faces(windows: Windows, grey, places, yaw: float, rng: np.random.Generator) -> None:
    middle = middle_of(places)
    for _ in range(FACES_A_PICTURE):
        # A search stops at steps of place, size and turn: what it compares is never quite centred
        width = FACE_IPDS * PX_PER_IPD * np.exp(rng.uniform(-0.09, 0.09))
        center = middle + rng.uniform(-0.025, 0.025, 2) * width
        windows.faces.append(_face_window(grey, center, width, rng.uniform(-0.15, 0.15)))
        windows.yaws.append(yaw)
    for _ in range(OTHERS_A_PICTURE):
        size = np.exp(rng.uniform(-0.8, 0.5))
        away = _away(rng, 0.25, 0.9) * FACE_IPDS * PX_PER_IPD
        if abs(np.log(size)) > 0.45 and rng.random() < 0.5:
            away *= 0.2  # of the wrong size alone
        width = FACE_IPDS * PX_PER_IPD * size
        windows.beside.append(_face_window(grey, middle + away, width, rng.uniform(-0.2, 0.2)))


def _cut_parts(windows: Windows, grey, places, yaw: float, rng: np.random.Generator) -> None:
    width = FACE_IPDS * PX_PER_IPD * np.exp(rng.uniform(-0.06, 0.06))
    roll = rng.uniform(-0.06, 0.06)
    center = middle_of(places) + rng.uniform(-0.02, 0.02, 2) * width
    c, s = np.cos(roll), np.sin(roll)
    windows.places.append((places - center) @ np.array([[c, -s], [s, c]]) / width)
    windows.place_yaws.append(yaw)
    for place, (name, (ipds, size)) in zip(places, MODULES.items(), strict=True):
        across = ipds * width / FACE_IPDS * np.exp(rng.uniform(-0.04, 0.04))

        def cut(at, across=across, size=size):
            window = _core.flat_window(grey, at, across, roll, *size, MODULE_IPD_PX)
            return window.ravel().astype(np.float32)

        windows.modules[name].append(cut(place))
        for _ in range(OTHERS_A_PICTURE):
            windows.beside_modules[name].append(cut(place + _away(rng, 0.1, 0.32) * PX_PER_IPD))


def _away(rng: np.random.Generator, nearest: float, furthest: float) -> np.ndarray:
    angle = rng.uniform(0, 2 * np.pi)
    return np.array([np.cos(angle), np.sin(angle)]) * rng.uniform(nearest, furthest)
