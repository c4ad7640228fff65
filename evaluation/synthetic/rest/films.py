# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the films and shows them as clips, kept in the cache while their inputs stand."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe
from mimetic.template.face_template import FaceTemplate

from .. import footage, scene
from ..clips import cache_folder
from ..expressions.films import DRAWING, SOURCES, TEXEL_STEP, _draw, film_key
from ..heads.films import _aside
from ..person import neutral_vertices
from ..recipes import Recipe
from .recipes import SHOWINGS, Showing

DRAWN_WITH = (*SOURCES, DRAWING, "rest/films")


@dataclass(frozen=True)
class ShownClip:
    kind: str
    name: str
    footage: Path
    truth: Path  # unit_values N x U: how far each of the face's units moves in every frame


def shown_clips(
    recipe: Recipe, template: FaceTemplate, report: Callable[[str], None]
) -> Iterator[ShownClip]:
    """A person's film in every showing, made if the cache lacks it."""
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    motion = scene.face_motion(recipe, template, neutral)
    numbers = (template.vertices, template.identity_modes, template.unit_modes)
    key = film_key(f"{recipe!r} {SHOWINGS!r}", numbers, DRAWN_WITH)
    folder = cache_folder() / f"{recipe.name}-{key}"
    if not folder.exists():
        report(f"{recipe.name}: rendering {recipe.num_frames} frames")
        drawn = scene.build(recipe, template, neutral, motion)
        with _aside(folder) as whole, tempfile.TemporaryDirectory() as made:
            paint = scene.paint(recipe, template, neutral, TEXEL_STEP)
            _draw(drawn, paint, Path(made), recipe.name)
            frames = footage.filmed(np.load(Path(made) / "frames.npy"), recipe)
            for number, showing in enumerate(SHOWINGS):
                _show(frames, motion.values, showing, recipe, whole / str(number))
    for number, showing in enumerate(SHOWINGS):
        shown = folder / str(number)
        name = f"{recipe.name}: {showing.kind}"
        yield ShownClip(showing.kind, name, shown.with_suffix(".mp4"), shown.with_suffix(".npz"))


def _show(
    frames: np.ndarray, values: np.ndarray, showing: Showing, recipe: Recipe, path: Path
) -> None:
    order = slice(None, None, -1 if showing.backward else 1)
    footage.encode(frames[order], path.with_suffix(".mp4"), recipe)
    if showing.bit_rate is not None:
        _starve(path.with_suffix(".mp4"), showing.bit_rate)
    np.savez(path.with_suffix(".npz"), unit_values=values[order])


def _starve(path: Path, bit_rate: int) -> None:
    """Encodes a clip again as a camera of small means does: in one pass, at so many bits/s."""
    before = path.with_suffix(".before.mp4")
    path.rename(before)
    command = [get_ffmpeg_exe(), "-y", "-loglevel", "error", "-i", str(before), "-c:v", "libx264"]
    command += ["-preset", "veryfast", "-tune", "zerolatency", "-b:v", str(bit_rate)]
    command += ["-maxrate", str(bit_rate), "-bufsize", str(bit_rate // 4), str(path)]
    subprocess.run(command, check=True)
    before.unlink()
