# SPDX-License-Identifier: GPL-3.0-or-later
"""Real clips captured again with something painted before the face: what does it change?

    python -m evaluation.runs.covered [--clips NAME ...] [--ways NAME ...] [--seconds S]

The first part of each fetched clip is captured as it is, then with glasses whose round rims are
5 mm thick, or 2 mm, a microphone's foam ball that stands still in the picture before chin and
lower lip, a hand that covers the mouth in the middle third, and a caption that stands still in the
picture before mouth and chin. Each is captured from the start:
face, rest and all. Where the face is covered nothing can be seen of it, so what differs there is
no error as long as the error bars say so; that is what is counted: the 95 % intervals of the
difference that hold 0, of the muscles and articulators that are beyond .1 in one of the two. Then
root mean squares of the differences, frames that are held (their quality is too low), and the
median angle between the head's turns; then the first and the second of these again, followed from
the fit of the clip as it is, so that the face, its rest and their error are the same in both.
Activations are counted at the strength that is assumed.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from mimetic import InvalidInput
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.score.scores import project
from mimetic.template.face_template import load_template
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from evaluation.runs import shown_again
from evaluation.runs.head_score import degrees_between
from evaluation.runs.shown_again import AS_IT_IS, Captured, captured, compare
from evaluation.runs.worn import RIM, Wearer, fill, with_rims
from evaluation.synthetic.noise import smoothstep

THIN_RIM = 0.001  # metres: half the width
FINER = 4  # samples a pixel along each axis, so that edges are smooth
# Metres: the ball's middle from the mouth's in the head frame, its radius, half the stand's width
BALL, BALL_RADIUS, STAND = (0.006, -0.019, 0.02), 0.022, 0.007
FOAM, STAND_GREY, GRAIN, SHINE = 36.0, 30.0, 6.0, 34.0  # grey levels
# Metres right and down of the mouth: from, to, half the width; share of the cheek's light
ARM = ((0.08, 0.02), (0.9, 0.77), 0.028, 0.9)
PALM = ((0.022, 0.004), (0.066, 0.008), 0.036, 0.95)
THUMB = ((0.054, -0.016), (0.026, -0.048), 0.0105, 0.97)
FINGERS = tuple(
    ((0.02, down), (0.02 - length, 1.1 * down - 0.004), 0.0092, light)
    for down, length, light in (
        (0.031, 0.06, 0.9),
        (0.0125, 0.075, 0.93),
        (-0.006, 0.08, 0.96),
        (-0.0245, 0.07, 0.99),
    )
)
SEAM, SEAM_LIGHT = 0.0012, 0.66  # metres about each finger, share of the cheek's light
WORDS = "I never said that you\nwould have to wait here"
LETTERS, LINES_DOWN = 0.016, 0.02  # metres: their size, and how far below the mouth they begin
PASSING = 0.1  # of the clip: how long the hand moves before and after the middle third
PAST_EDGE = 0.16  # metres: where its middle is as far beyond the picture, the hand is not seen

Frames = NDArray[np.uint8]  # N x H x W x 3


def _mouth(wearer: Wearer) -> NDArray[np.float64]:
    """Between its corners at rest, (3,) in the head frame."""
    template = load_template()
    corners = [template.landmark(f"mouth_corner.{side}") for side in "LR"]
    return wearer.neutral_vertices[corners].mean(0)


def _seen(point: NDArray, wearer: Wearer, i: int) -> tuple[NDArray[np.float64], float]:
    """The pixel of a point (3,) of the head frame in row i, and pixels a metre there."""
    pose = wearer.head_pose[i]
    depth = pose[2, :3] @ point + pose[2, 3]
    return project(point[None], pose, wearer.intrinsics)[0], wearer.intrinsics[0, 0] / depth


def _bar(start: NDArray, end: NDArray, half_width: float) -> NDArray[np.float64]:
    """The outline (K,2) of a bar with round ends."""
    along = end - start
    angles = np.linspace(-np.pi / 2, np.pi / 2, 24) + np.arctan2(along[1], along[0])
    arc = half_width * np.stack([np.cos(angles), np.sin(angles)], 1)
    return np.concatenate([end + arc, start - arc])


def microphone(frames: Frames, wearer: Wearer) -> Frames:
    """A foam ball on a stand where chin and lower lip are in the middle frame, in all of them."""
    height, width = frames.shape[1:3]
    middle, scale = _seen(_mouth(wearer) + np.array(BALL), wearer, len(frames) // 2)
    radius = BALL_RADIUS * scale
    ball = _bar(middle, middle, radius)
    stand = _bar(middle, np.array((middle[0] + 0.5 * radius, 2 * height)), STAND * scale)
    places = np.stack(np.meshgrid(np.arange(width), np.arange(height)), -1)
    from_shine = (places - (middle - 0.4 * radius)) / radius
    grey = FOAM + SHINE * np.exp(-2 * (from_shine**2).sum(-1))
    grain = np.random.default_rng(3).normal(0, GRAIN, (height, width))
    foam = np.repeat(np.clip(grey + grain, 0, 255)[..., None], 3, 2)
    covered = frames.copy()
    for image in covered:
        fill(image, stand, np.full(3, STAND_GREY), finer=FINER)
        fill(image, ball, foam, finer=FINER)
    return covered


def hand(frames: Frames, wearer: Wearer) -> Frames:
    """A hand of the cheek's colour, which comes before the mouth from the right and goes again."""
    height, width = frames.shape[1:3]
    mouth, colour = _mouth(wearer), _cheek(frames[0], wearer)
    towards = np.subtract(ARM[1], ARM[0]) / np.linalg.norm(np.subtract(ARM[1], ARM[0]))
    covered = frames.copy()
    for i, image in enumerate(covered):
        place, scale = _seen(mouth, wearer, i)
        time = i / max(len(frames) - 1, 1)
        is_there = smoothstep(-PASSING, 0, min(time - 1 / 3, 2 / 3 - time))
        out = ((np.array((width, height)) - place) / towards).min() + PAST_EDGE * scale
        place = place + (1 - is_there) * out * towards
        for part in (ARM, PALM, *FINGERS, THUMB):
            start, end, half_width, light = part
            ends = place + scale * np.array((start, end))
            if part not in (ARM, PALM):
                seam = _bar(*ends, scale * (half_width + SEAM))
                fill(image, seam, SEAM_LIGHT * colour, finer=FINER)
            fill(image, _bar(*ends, scale * half_width), light * colour, finer=FINER)
    return covered


def caption(frames: Frames, wearer: Wearer) -> Frames:
    """Two white lines with black outlines, where mouth and chin are in the middle frame."""
    below = _mouth(wearer) - np.array((0, LINES_DOWN, 0))
    place, scale = _seen(below, wearer, len(frames) // 2)
    size = LETTERS * scale
    covered = frames.copy()
    for i, frame in enumerate(frames):
        image = Image.fromarray(frame)
        ImageDraw.Draw(image).multiline_text(
            tuple(place),
            WORDS,
            fill="white",
            font=ImageFont.load_default(size),
            anchor="mm",
            align="center",
            stroke_width=max(1, round(size / 9)),
            stroke_fill="black",
        )
        covered[i] = np.asarray(image)
    return covered


def _cheek(image: NDArray[np.uint8], wearer: Wearer) -> NDArray[np.float64]:
    """The colour (3,) of the right cheek in the first frame."""
    corner = wearer.neutral_vertices[load_template().landmark("mouth_corner.R")]
    pixel, _ = _seen(corner + np.array((-0.012, 0.012, 0)), wearer, 0)
    x, y = np.clip(pixel.astype(int), 4, np.array(image.shape[1::-1]) - 4)
    return np.median(image[y - 4 : y + 4, x - 4 : x + 4].reshape(-1, 3), axis=0)


WAYS: dict[str, Callable[[Frames, Wearer], Frames]] = {
    "glasses": lambda frames, wearer: with_rims(frames, wearer, RIM, finer=FINER),
    "thin glasses": lambda frames, wearer: with_rims(frames, wearer, THIN_RIM, finer=FINER),
    "microphone": microphone,
    "hand": hand,
    "caption": caption,
}
COLUMNS = shown_again.COLUMNS | {
    "held": ("frames held", ".0f"),
    "turn": ("turn deg", ".1f"),
    "followed": ("one fit", ".2f"),
    "moved": ("its muscles", ".3f"),
}


def figures(first: Performance, second: Performance) -> dict[str, float]:
    """How far a performance of covered frames is from that of the frames as they are."""
    turns = [performance.head_pose[:, :3, :3] for performance in (first, second)]
    return shown_again.figures(first, second, AS_IT_IS) | {
        "held": float((second.quality < HELD_QUALITY).sum()),
        "turn": float(np.median(degrees_between(*turns))),
    }


def _covered(frames: Frames, fps: float, first: Captured, way: str) -> dict[str, float]:
    bare = first.performance
    hidden = WAYS[way](frames, bare)
    try:
        alone = figures(bare, captured(hidden, fps, fit=first.fit).performance)
    except InvalidInput:  # in the fit's frame it is not seen where the fit has it
        alone = {"within": np.nan, "muscles": np.nan}
    return figures(bare, captured(hidden, fps).performance) | {
        "followed": alone["within"],
        "moved": alone["muscles"],
    }


def main(arguments: list[str] | None = None) -> int:
    return compare("covered", __doc__, WAYS, COLUMNS, _covered, arguments)


if __name__ == "__main__":
    sys.exit(main())
