# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the timed clips and writes their truth, kept in the cache while their inputs stand."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .. import scene
from ..clips import Clip, _truth, cache_folder
from ..expressions.films import DRAWING, SIMULATED_BY, SOURCES, film, film_key
from ..heads.films import _aside
from ..person import neutral_vertices
from ..recipes import Recipe

ACTION_UNITS = ("action_units.toml",)


def timing_clip(
    recipe: Recipe,
    template: FaceTemplate,
    report: Callable[[str], None] = lambda _: None,
    face_motion: Callable[[Recipe, FaceTemplate, np.ndarray], scene.Motion] = scene.face_motion,
) -> Clip:
    """The clip of a recipe, rendered unless the cache has it."""
    key = _key(recipe, template, ACTION_UNITS if recipe.kind == "units" else SIMULATED_BY)
    folder = cache_folder() / f"{recipe.name}-{key}"
    clip = Clip(recipe.name, folder / f"{recipe.name}.mp4", folder / f"{recipe.name}.truth.npz")
    if clip.footage.exists() and clip.truth.exists():
        return clip
    report(f"{recipe.name}: rendering {recipe.num_frames} frames")
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    motion = face_motion(recipe, template, neutral)
    drawn = scene.build(recipe, template, neutral, motion)
    with _aside(folder) as whole, tempfile.TemporaryDirectory() as aside:
        made = Path(aside)
        film(drawn, recipe, template, made, whole / clip.footage.name)
        _truth(recipe, template, drawn, motion, made).save(whole / clip.truth.name)
    return clip


def _key(recipe: Recipe, template: FaceTemplate, data: tuple[str, ...]) -> str:
    numbers = (template.vertices, template.identity_modes)
    return film_key(repr(recipe), numbers, (*SOURCES, DRAWING, "timing/firing"), data)
