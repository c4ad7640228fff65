# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders people who speak and wink, and keeps the clips while their inputs stand."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .. import scene
from ..clips import Clip, cache_folder
from ..expressions.films import DRAWING, SOURCES, film, film_key
from ..heads.films import _aside
from ..person import neutral_vertices
from .recipes import SHUT, SpeechClip

DRAWN_WITH = (*SOURCES, DRAWING, "speech/films")


def speech_clip(wanted: SpeechClip, template: FaceTemplate, report: Callable[[str], None]) -> Clip:
    """The clip, rendered unless the cache has it. Its truth: vertices (N x V x 3, of the control
    mesh, head frame, metres), head_pose (N x 4 x 4), intrinsics (3 x 3), lids_shut (N x 2, share
    of the way of the left and the right eye's lids), lid_motions (L x 2, frames from 1)."""
    recipe = wanted.recipe
    numbers = (template.vertices, template.identity_modes, template.unit_modes)
    folder = cache_folder() / f"{recipe.name}-{film_key(repr(wanted), numbers, DRAWN_WITH)}"
    made = Clip(recipe.name, folder / f"{recipe.name}.mp4", folder / f"{recipe.name}.speech.npz")
    if made.footage.exists() and made.truth.exists():
        return made
    report(f"{recipe.name}: rendering {recipe.num_frames} frames")
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    motion = scene.face_motion(recipe, template, neutral)
    drawn = scene.build(recipe, template, neutral, motion)
    lids = [motion.names.index(f"eyeBlink{side}") for side in ("Left", "Right")]
    spans = [(recipe.fps * start + 1, recipe.fps * end + 1) for _, start, end in wanted.lids]
    with _aside(folder) as whole, tempfile.TemporaryDirectory() as aside:
        film(drawn, recipe, template, Path(aside), whole / made.footage.name)
        np.savez_compressed(
            whole / made.truth.name,
            vertices=drawn.vertices,
            head_pose=drawn.head_pose,
            intrinsics=drawn.intrinsics,
            lids_shut=motion.values[:, lids] / SHUT,
            lid_motions=np.round(spans).astype(np.int64),
        )
    return made
