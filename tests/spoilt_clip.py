# SPDX-License-Identifier: GPL-3.0-or-later
"""The rendered clip with something before its mouth for a while, as a hand would be, and how far a
capture of it is from the truth."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe
from mimetic.performance.corrections import SkinPin
from mimetic.performance.pinned_places import PinnedPlaces, place_under
from mimetic.performance.places import RefinedSurface
from mimetic.template.face_template import load_template

FIRST, LAST = 36, 46  # frames in which the mouth is covered; it opens at 33
COLOUR = "0x9c6a52"


def cover_mouth(footage: Path, fit, out: Path) -> None:
    """Writes the footage with a box over the mouth, where the fit has it; the head hardly moves."""
    template = load_template()
    corners = [template.landmark(f"mouth_corner.{side}") for side in "LR"]
    mouth = fit.neutral_vertices(template)[corners] @ fit.head_pose[:3, :3].T + fit.head_pose[:3, 3]
    pixels = mouth @ fit.intrinsics.T
    (left, y), (right, _) = pixels[:, :2] / pixels[:, 2:]
    width = abs(right - left)
    box = (min(left, right) - 0.3 * width, y - 0.4 * width, 1.6 * width, 1.3 * width)
    x, y, w, h = (round(float(number)) for number in box)
    enabled = f"enable='between(n,{FIRST - 1},{LAST - 1})'"
    draw = f"drawbox=x={x}:y={y}:w={w}:h={h}:color={COLOUR}:t=fill:{enabled}"
    command = [get_ffmpeg_exe(), "-v", "error", "-y", "-i", footage, "-vf", draw]
    subprocess.run([*command, "-c:v", "libx264", "-crf", "12", out], check=True)


def moving_points(truth) -> np.ndarray:
    """Indices of the true points that move most while the mouth is covered and are always seen."""
    moved = np.linalg.norm(truth.tracks[FIRST + 4] - truth.tracks[FIRST - 6], axis=1)
    return np.array([k for k in np.argsort(-moved)[:60] if truth.visible[:, k].all()])


def places_of(performance, truth) -> tuple[list[SkinPin], np.ndarray]:
    """Those points as pins of the first frame, and their true pixels, frames x P x 2."""
    surface = RefinedSurface(performance)
    pins, points = [], []
    for k in moving_points(truth):
        place = place_under(surface, tuple(truth.tracks[0, k]), 0)
        if place is not None and place[0] < load_template().num_skin_faces:
            pins.append(SkinPin(*place, tuple(truth.tracks[0, k])))
            points.append(k)
    return pins, truth.tracks[:, points]


def pixels_of(performance, pins, frames) -> np.ndarray:
    """Frames x P x 2."""
    at = PinnedPlaces(load_template(), pins)
    rows = [performance.index_of(frame) for frame in frames]
    return np.stack(
        [performance.project(at.positions(performance.surface_in_camera(i))) for i in rows]
    )


def error(performance, places, frames) -> float:
    """Pixels, the root of the mean square over these frames."""
    pins, tracks = places
    off = pixels_of(performance, pins, frames) - tracks[[frame - 1 for frame in frames]]
    return float(np.sqrt((off**2).sum(axis=2).mean()))
