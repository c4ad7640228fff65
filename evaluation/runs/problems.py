# SPDX-License-Identifier: GPL-3.0-or-later
"""What goes wrong and why (docs/guide/problems.md): one drawn take, filmed well and badly.

    python -m evaluation.runs.problems --out SHEET.jpg [--only NAME ...]

Prints how much of the motion each capture explains, and draws a frame of each with what was found.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.report.overlay import write_overlay
from mimetic.score.score import score
from mimetic.score.text_table import text_table
from mimetic.score.truth import Truth
from mimetic.solve.clip_capture import capture
from mimetic.template.face_template import load_template
from numpy.typing import NDArray

from evaluation.anatomy.anatomy_sheet import write_sheet
from evaluation.runs.worn import glasses, hair
from evaluation.synthetic import footage
from evaluation.synthetic.clips import clip
from evaluation.synthetic.motion import HeadMotion
from evaluation.synthetic.noise import smoothstep
from evaluation.synthetic.recipes import HELD_OUT, Recipe

Frames = NDArray[np.uint8]  # N x H x W x 3
TAKE = HELD_OUT[0]
PROFILE = replace(TAKE, name="problems-profile", head_motion=HeadMotion(yaw=75))
SHOWN_FRAME = 42  # from 1: the smile
COLUMNS = {
    "image": ("in the picture", ".2f"),
    "space": ("in space", ".2f"),
    "turn": ("turn deg", ".1f"),
    "quality": ("quality", ".2f"),
    "held": ("held", ".0f"),
}


@dataclass(frozen=True)
class Problem:
    """One way to film: what it does to frames, given them, the truth and a generator."""

    title: str
    spoil: Callable[[Frames, Truth, np.random.Generator], Frames]
    recipe: Recipe = TAKE
    crf: int = 18


def _as_it_is(frames: Frames, truth: Truth, rng: np.random.Generator) -> Frames:
    return frames


def _dim(frames: Frames, truth: Truth, rng: np.random.Generator) -> Frames:
    """A twelfth of the light, and the noise that a camera then adds."""
    dark = frames / 12.0 + rng.normal(0, 3.0, frames.shape)
    return _pixels(dark)


def _changing(frames: Frames, truth: Truth, rng: np.random.Generator) -> Frames:
    """A television beside the person: from the side, up and down one and a half times a second."""
    times = np.arange(len(frames))[:, None, None, None] / truth.fps
    beside = np.linspace(1, 0, frames.shape[2])[None, None, :, None]
    return _pixels(frames * (0.7 + 0.6 * beside * np.sin(2 * np.pi * 1.5 * times)))


def _half(frames: Frames, truth: Truth, rng: np.random.Generator) -> Frames:
    """Light from one side alone: the other half of the face is black."""
    x = np.arange(frames.shape[2])
    middle = truth.tracks[0, :, 0].mean()
    gain = 0.05 + 0.95 * smoothstep(middle + 8, middle - 20, x)
    return _pixels(frames * gain[None, None, :, None])


def _small(frames: Frames, truth: Truth, rng: np.random.Generator) -> Frames:
    """A quarter of the size: a face of some 29 pixels."""
    count, height, width, _ = frames.shape
    return _pixels(frames.reshape(count, height // 4, 4, width // 4, 4, 3).mean((2, 4)))


def _pixels(values: NDArray) -> Frames:
    return np.clip(np.round(values), 0, 255).astype(np.uint8)


PROBLEMS = {
    "as filmed": Problem("as filmed", _as_it_is),
    "dim": Problem("a twelfth of the light", _dim),
    "changing light": Problem("light that changes", _changing),
    "one side": Problem("light from one side", _half),
    "hair": Problem("hair over the brows", hair),
    "glasses": Problem("glasses with a reflection", glasses),
    "small": Problem("a quarter of the pixels", _small),
    "compressed": Problem("compressed as by a messenger", _as_it_is, crf=40),
    "profile": Problem("turned to the side", _as_it_is, recipe=PROFILE),
}


def film(problem: Problem, folder: Path) -> tuple[Path, Truth]:
    """The take as filmed this way, and the truth in its pixels."""
    made = clip(problem.recipe, load_template(), print)
    truth = Truth.load(made.truth)
    frames = np.stack([image for _, image in Footage(made.footage)])
    spoilt = problem.spoil(frames, truth, np.random.default_rng(5))
    path = folder / "clip.mp4"
    footage.encode(spoilt, path, replace(problem.recipe, crf=problem.crf))
    shrunk = spoilt.shape[2] / frames.shape[2]
    if shrunk == 1:
        return path, truth
    to_small = np.array([[shrunk, 0, (shrunk - 1) / 2], [0, shrunk, (shrunk - 1) / 2], [0, 0, 1]])
    tracks = truth.tracks * shrunk + (shrunk - 1) / 2
    size = np.array([spoilt.shape[2], spoilt.shape[1]])
    intrinsics = to_small @ truth.intrinsics
    return path, replace(truth, tracks=tracks, image_size=size, intrinsics=intrinsics)


def figures(truth: Truth, performance: Performance) -> dict[str, float]:
    result = score(truth, performance)
    return {
        "image": result.image["mimetic"]["nonrigid_r2"],
        "space": result.surface["r2"],
        "turn": float(np.mean([result.head[f"{axis}_deg"] for axis in ("pitch", "yaw", "roll")])),
        "quality": float(np.median(performance.quality)),
        "held": float(np.sum(performance.quality < HELD_QUALITY)),
    }


def picture(performance: Performance, path: Path, folder: Path) -> Frames:
    """The shown frame with what was captured over it, as `overlay.mp4` has it."""
    overlay = folder / "overlay.mp4"
    write_overlay(performance, Footage(path), overlay)
    return Footage(overlay).read(SHOWN_FRAME)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="evaluation.runs.problems", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="picture to write, .png or .jpg")
    parser.add_argument("--only", nargs="+", choices=PROBLEMS, help="these alone")
    options = parser.parse_args(arguments)
    rows, pictures = {}, {}
    for name in options.only or PROBLEMS:
        problem = PROBLEMS[name]
        with tempfile.TemporaryDirectory() as aside:
            path, truth = film(problem, Path(aside))
            try:
                performance = capture(path)
            except (InvalidInput, UnreadableMedia) as error:
                print(f"{problem.title}: {error}")
                pictures[problem.title] = _tile(Footage(path).read(SHOWN_FRAME))
                continue
            rows[problem.title] = figures(truth, performance)
            pictures[problem.title] = _tile(picture(performance, path, Path(aside)))
        print(text_table("", COLUMNS, {problem.title: rows[problem.title]}), flush=True)
    print(text_table("all", COLUMNS, rows))
    write_sheet(pictures, options.out, columns=3)
    return 0


def _tile(image: Frames) -> Frames:
    """320 pixels wide, by the nearest pixel: small footage shows how small it is."""
    height, width = image.shape[:2]
    rows, columns = np.arange(240) * height // 240, np.arange(320) * width // 320
    return image[rows][:, columns]


if __name__ == "__main__":
    sys.exit(main())
