# SPDX-License-Identifier: GPL-3.0-or-later
"""How much a face in an image is at rest: the reference frame must show the neutral face."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.shared.luminance import GREY

Window = NDArray[np.float64]

# What faces at rest stay under, and how fast the score falls beyond (real webcam clips): parts of
# the cheek's brightness
AT_REST = {
    "mouth_contrast": (0.13, 0.03),  # two lips and a line; teeth or an open mouth's dark add to it
    "mouth_edges": (0.09, 0.02),
    "cheek_contrast": (0.09, 0.04),  # the smile's fold
    "pupil_brightness": (0.33, 0.08),  # closed lids are as bright as skin
}
LEAST_SPREAD = 0.015  # pupil distances by which a still face's features seem to move
USUAL = 1.5  # spreads
LEAST_REST = 0.1  # of the best frame's score: below, a face is plainly not at rest
LEVEL, FRONTAL, MOUTH_FRONTAL = 0.25, 0.1, 0.12  # rad, and pupil distances off the middle
SMOOTH = 0.75  # of the second differences in a face: the borders of an encoder's blocks are above
DETAILED = 0.75  # of a clip's frames have less detail than its detailed ones


def rest_score(image: NDArray[np.uint8], face: _core.FaceFeatures) -> float:
    """0 to 1: frontal, level, eyes open and mouth at rest. image: (H, W, 3) RGB uint8."""
    view = _FaceView(image, face)
    score = face.likelihood * view.frontal()
    for name, value in view.motion().items():
        usual, spread = AT_REST[name]
        score *= np.exp(-0.5 * (max(0.0, value - usual) / spread) ** 2)
    return float(score)


def detail(image: NDArray[np.uint8], face: _core.FaceFeatures) -> float:
    """What a face (image: (H, W, 3) RGB uint8) shows beyond smooth shades, grey levels.

    An encoder that is short of bits, a blur and a bad focus take it away.
    """
    left, top, width, height = (round(v) for v in face.box)
    inside = image[max(0, top) : top + height, max(0, left) : left + width] @ GREY
    bends = np.sort(np.abs(np.diff(inside, 2, axis=1)), axis=None)
    smooth = bends[: int(SMOOTH * len(bends))]
    return float(smooth.mean()) if len(smooth) else 0.0


def chances_of_rest(
    scores: NDArray[np.float64], details: NDArray[np.float64], expressions: NDArray[np.float64]
) -> NDArray[np.float64]:
    """F: which frames of a clip serve best as its reference; the greatest is the best.

    scores: F of `rest_score`; details: F of `detail`, which count by what they tell of motion, the
    square of the gradients, beside what the clip's better frames have; expressions: F x 6.
    """
    usual = usual_expression(expressions, scores)
    full = max(float(np.quantile(details, DETAILED)), 1e-6)
    sharpness = np.minimum(details / full, 1) ** 2
    return scores * sharpness * usual * shared_expression(expressions, scores * sharpness)


def shared_expression(
    expressions: NDArray[np.float64], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """How many frames share each frame's expression (F x 6), as a part of the most: 0 to 1 (F).

    A face comes back to the same rest, and all of it at once; what moves is elsewhere in every
    frame. weights: F, of what the frames count for.
    """
    values = np.ma.masked_invalid(expressions)
    apart = np.ma.abs(values[:, None] - values[None]).filled(0.0) / LEAST_SPREAD
    near = np.exp(-0.5 * (apart**2).mean(axis=2) * 2)
    number = near @ weights
    return number / max(float(number.max()), 1e-300)


def expression(face: _core.FaceFeatures) -> NDArray[np.float64]:
    """Heights of brows and mouth corners below the pupils, the lips' height and the mouth's width.

    Six values in pupil distances, nan where a feature was not found. They say what changed from
    frame to frame, not what is neutral: how high brows sit at rest differs between people.
    """
    places = {feature.name: np.array(feature.position) for feature in face.features}
    curves = {curve.name: np.asarray(curve.points) for curve in face.curves}
    middle = (places["pupil.R"] + places["pupil.L"]) / 2
    across = places["pupil.L"] - places["pupil.R"]
    down = np.array([-across[1], across[0]])
    square = across @ across

    def height(name: str) -> float:
        points = curves.get(name, np.full((1, 2), np.nan))
        return float(np.median((points - middle) @ down)) if len(points) else np.nan

    left, right = places["mouth_corner.L"], places["mouth_corner.R"]
    values = [
        height("brow.L"),
        height("brow.R"),
        (left - middle) @ down,
        (right - middle) @ down,
        (places["lip_lower"] - places["lip_upper"]) @ down,
        (left - right) @ across,
    ]
    return np.array(values) / square


def usual_expression(
    expressions: NDArray[np.float64], scores: NDArray[np.float64]
) -> NDArray[np.float64]:
    """How usual each frame's expression (F x 6) is within its clip: 0 to 1 (F).

    Each part of a face rests in more of a clip's frames than not, though rarely all at once; so the
    median of each value is its rest, whatever the person looks like. scores: F of `rest_score`;
    where most frames are plainly not at rest, a long smile, the others alone tell what is usual.
    """
    is_informative = scores >= LEAST_REST * scores.max()
    if is_informative.mean() >= 0.5:
        is_informative[:] = True
    values = np.ma.masked_invalid(expressions)
    off = np.ma.abs(values - np.ma.median(values[is_informative], axis=0)).filled(0.0)
    spread = np.maximum(1.48 * np.median(off[is_informative], axis=0), LEAST_SPREAD)
    return np.exp(-0.5 * ((off / spread).max(axis=1) / USUAL) ** 2)


class _FaceView:
    """The picture in pupil distances from the mid-eye point, x right, y down."""

    def __init__(self, image: NDArray[np.uint8], face: _core.FaceFeatures) -> None:
        self._grey = image @ GREY
        places = {feature.name: np.array(feature.position) for feature in face.features}
        self._middle = (places["pupil.R"] + places["pupil.L"]) / 2
        self._across = places["pupil.L"] - places["pupil.R"]
        self._down = np.array([-self._across[1], self._across[0]])
        axes = np.array([self._across, self._down]) / (self._across @ self._across)
        self._places = {name: axes @ (place - self._middle) for name, place in places.items()}

    def motion(self) -> dict[str, float]:
        """Values of AT_REST."""
        skin = np.median([self._window((x, 0.65), 0.1, 0.1) for x in (-0.5, 0.5)]) + 1
        nose = self._midway("ala")
        mouth = self._window((nose, 1.15), 0.4, 0.3)
        cheeks = [self._window((nose + x, 0.95), 0.12, 0.15).std() for x in (-0.5, 0.5)]
        pupils = [self._window(self._places[n], 0.07, 0.07).mean() for n in ("pupil.L", "pupil.R")]
        return {
            "mouth_contrast": mouth[:, 3:-3].std() / skin,
            "mouth_edges": np.abs(np.diff(mouth[::3], axis=0)).mean() / skin,
            "cheek_contrast": max(cheeks) / skin,
            "pupil_brightness": np.mean(pupils) / skin,
        }

    def frontal(self) -> float:
        roll = np.arctan2(self._across[1], self._across[0])
        offsets = (self._midway("ala") / FRONTAL, self._midway("mouth_corner") / MOUTH_FRONTAL)
        return float(np.exp(-0.5 * (offsets[0] ** 2 + offsets[1] ** 2 + (roll / LEVEL) ** 2)))

    def _midway(self, name: str) -> float:
        return float((self._places[name + ".L"] + self._places[name + ".R"])[0]) / 2

    def _window(self, center: Sequence[float] | NDArray, half_x: float, half_y: float) -> Window:
        """41 x 41 grey values round a point."""
        x, y = np.meshgrid(np.linspace(-half_x, half_x, 41), np.linspace(-half_y, half_y, 41))
        spots = self._middle + (center[0] + x)[..., None] * self._across
        spots = np.rint(spots + (center[1] + y)[..., None] * self._down).astype(int)
        rows, columns = self._grey.shape
        return self._grey[spots[..., 1].clip(0, rows - 1), spots[..., 0].clip(0, columns - 1)]
