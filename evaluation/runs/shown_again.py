# SPDX-License-Identifier: GPL-3.0-or-later
"""Real clips captured again, shown in other ways: is the same face read as the same muscles?

    python -m evaluation.runs.shown_again [--clips NAME ...] [--ways NAME ...] [--seconds S]

The first part of each fetched clip, as it is and mirrored, backward, at half the size, moved,
rolled, coded anew with few bits, and with the noise of a dark room, is each captured from the
start: face, rest and all. The same muscles must come out, mirrored ones of the other side. Nothing
here says that they are right; but what differs more than the error bars allow is wrong in one of
the two at least, and no truth is needed to see it. Printed are the 95 % intervals of the difference
that hold 0, of the muscles and articulators that are beyond .1 in one of the two, and root mean
squares of the differences.
Activations are counted at the strength that is assumed, not at the person's own extent.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from mimetic import InvalidInput
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.muscles.sides import mirrored_name, mirrored_sign
from mimetic.performance.document import Performance
from mimetic.performance.gaze import GAZE
from mimetic.score.text_table import text_table
from mimetic.solve import clip_capture
from mimetic.solve.capture_summary import CaptureSummary
from numpy.typing import NDArray
from PIL import Image

from evaluation.progress import to_stderr
from evaluation.runs.real_labels import CLIPS, footage_of
from evaluation.synthetic.footage import encode
from evaluation.synthetic.recipes import TEST

ACTIVE = 0.1
WITHIN = 1.96  # standard deviations
FINE, COARSE = 4, 34  # constant rate factors of H.264
ROLL = 8  # degrees
MOVED = (16, 9)  # pixels right, down
GRAY = (128, 128, 128)
# Of a camera in a dark room: electrons of white, s.d. of reading as a share of white, s.d. of
# colour in grey levels and its grain in pixels, share of grey levels that is left
ELECTRONS, READING, COLOUR, GRAIN, DARK = 60, 0.02, 14.0, 4, 0.8
GAMMA = 2.2

Frames = NDArray[np.uint8]  # N x H x W x 3


def _half(frames: Frames) -> Frames:
    height, width = frames.shape[1:3]
    even = frames[:, : height // 4 * 4, : width // 4 * 4].astype(np.uint16)
    summed = even[:, ::2, ::2] + even[:, 1::2, ::2] + even[:, ::2, 1::2] + even[:, 1::2, 1::2]
    return ((summed + 2) // 4).astype(np.uint8)


def _moved(frames: Frames) -> Frames:
    right, down = MOVED
    moved = np.full_like(frames, GRAY[0])
    moved[:, down:, right:] = frames[:, :-down, :-right]
    return moved


def _rolled(frames: Frames) -> Frames:
    def rolled(frame: Frames) -> Frames:
        image = Image.fromarray(frame).rotate(ROLL, Image.Resampling.BICUBIC, fillcolor=GRAY)
        return np.asarray(image)

    return np.stack([rolled(frame) for frame in frames])


def _in_dark_room(frames: Frames) -> Frames:
    """New noise in each frame: of few electrons, of reading them, of colour in coarse grains."""
    rng = np.random.default_rng(9)
    height, width = frames.shape[1:3]

    def noisy(frame: Frames) -> Frames:
        light = rng.poisson((frame / 255) ** GAMMA * ELECTRONS) / ELECTRONS
        light = np.clip(light + rng.normal(0, READING, frame.shape), 0, None)
        grains = rng.normal(0, COLOUR, (-(-height // GRAIN), -(-width // GRAIN), 3))
        grains -= grains.mean(axis=2, keepdims=True)
        colour = grains.repeat(GRAIN, axis=0).repeat(GRAIN, axis=1)[:height, :width]
        levels = 255 * DARK * light ** (1 / GAMMA) + colour
        return np.clip(np.round(levels), 0, 255).astype(np.uint8)

    return np.stack([noisy(frame) for frame in frames])


AS_IT_IS, MIRRORED, BACKWARD, CODED = "as it is", "mirrored", "backward", "coded anew"
WAYS: dict[str, Callable[[Frames], Frames]] = {
    MIRRORED: lambda frames: frames[:, :, ::-1],
    BACKWARD: lambda frames: frames[::-1],
    "half the size": _half,
    "moved": _moved,
    "rolled": _rolled,
    CODED: lambda frames: frames,
    "dark room": _in_dark_room,
}
COLUMNS = {
    "within": ("hold 0", ".2f"),
    "muscles": ("muscles", ".3f"),
    "articulators": ("articulators", ".3f"),
    "worst": ("worst", ".2f"),
}


@dataclass(frozen=True)
class Captured:
    performance: Performance
    fit: FaceFit  # that it was followed from


def captured(frames: Frames, fps: float, crf: int = FINE, fit: FaceFit | None = None) -> Captured:
    """Of frames that are coded first; fit: of the same frame, found if none is given.

    Raises InvalidInput.
    """
    summary = CaptureSummary()
    with TemporaryDirectory() as folder:
        path = Path(folder) / "clip.mp4"
        encode(np.ascontiguousarray(frames), path, replace(TEST, fps=round(fps), crf=crf))
        performance = clip_capture.capture(path, fit=fit, summary=summary)
    assert summary.fit is not None
    return Captured(performance, summary.fit)


def curves(performance: Performance, way: str) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Values and standard deviations, N x M each, in the frames and on the sides of the clip as it
    is: of the muscles, in units of the assumed strength, then of the articulators but gaze."""
    assert performance.articulator_values_std is not None  # of a capture
    names = [*performance.muscles, *performance.articulators]
    values = np.hstack([performance.activations, performance.articulator_values])
    std = np.hstack([performance.activations_std, performance.articulator_values_std])
    if performance.muscle_extent is not None:
        values[:, : len(performance.muscles)] *= performance.muscle_extent
        std[:, : len(performance.muscles)] *= performance.muscle_extent
    if way == MIRRORED:
        columns = [names.index(mirrored_name(name)) for name in names]
        values, std = values[:, columns], std[:, columns]
        values *= [mirrored_sign(name) for name in names]
    kept = [name not in GAZE for name in names]
    step = -1 if way == BACKWARD else 1
    return values[::step, kept], std[::step, kept]


def figures(first: Performance, second: Performance, way: str) -> dict[str, float]:
    """How far two performances of the same frames are apart."""
    (values, std), (others, others_std) = curves(first, AS_IT_IS), curves(second, way)
    apart, allowed = np.abs(others - values), WITHIN * np.hypot(std, others_std)
    active = np.maximum(np.abs(values), np.abs(others)) > ACTIVE
    num_muscles = len(first.muscles)
    return {
        "within": float((apart <= allowed)[active].mean()),
        "muscles": float(np.sqrt(np.mean(apart[:, :num_muscles] ** 2))),
        "articulators": float(np.sqrt(np.mean(apart[:, num_muscles:] ** 2))),
        "worst": float(apart.mean(axis=0).max()),
    }


def shown(frames: Frames, fps: float, first: Captured, way: str) -> dict[str, float]:
    """Figures of the frames shown in one way, beside their first capture; raises InvalidInput."""
    second = captured(WAYS[way](frames), fps, COARSE if way == CODED else FINE)
    return figures(first.performance, second.performance, way)


def compare(
    name: str,
    description: str | None,
    ways: Collection[str],
    columns: dict[str, tuple[str, str]],
    of_way: Callable[[Frames, float, Captured, str], dict[str, float]],
    arguments: list[str] | None,
) -> int:
    """A command that captures clips, and again in each way, and prints figures; its exit code.

    of_way: figures of a clip's frames, their rate, their capture as they are, and a way.
    """
    parser = argparse.ArgumentParser(prog=f"evaluation.runs.{name}", description=description)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--clips", nargs="+", choices=CLIPS, default=CLIPS, metavar="NAME")
    parser.add_argument("--ways", nargs="+", choices=ways, default=list(ways), metavar="NAME")
    parser.add_argument("--seconds", type=float, default=3.0, help="of each clip (default: 3)")
    options = parser.parse_args(arguments)
    rows: dict[str, dict[str, float]] = {}
    try:
        for clip in options.clips:
            source = Footage(footage_of(clip))
            last = min(source.num_frames, round(options.seconds * source.fps))
            frames = np.stack([image for _, image in source.frames(1, last)])
            to_stderr(f"{clip}, {last} frames, {AS_IT_IS}")
            first = captured(frames, source.fps)
            for way in options.ways:
                to_stderr(f"{clip}, {way}")
                rows[f"{clip}, {way}"] = of_way(frames, source.fps, first, way)
    except (InvalidInput, OSError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 2
    print(text_table(name.replace("_", " "), columns, rows))
    return 0


def main(arguments: list[str] | None = None) -> int:
    return compare("shown_again", __doc__, WAYS, COLUMNS, shown, arguments)


if __name__ == "__main__":
    sys.exit(main())
