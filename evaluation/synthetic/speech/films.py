# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders people who speak and wink, and keeps the clips while their inputs stand."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .. import footage, scene
from ..clips import BPY_VERSION, Clip, cache_folder
from ..expressions.films import SOURCES, TEXEL_STEP, _draw
from ..heads.films import _aside
from ..person import neutral_vertices
from .recipes import SHUT, SpeechClip

DRAWN_WITH = (*SOURCES, "expressions/draw_frames", "speech/films")


def speech_clip(wanted: SpeechClip, template: FaceTemplate, report: Callable[[str], None]) -> Clip:
    """The clip, rendered unless the cache has it. Its truth: vertices (N x V x 3, of the control
    mesh, head frame, metres), head_pose (N x 4 x 4), intrinsics (3 x 3), lids_shut (N x 2, share
    of the way of the left and the right eye's lids), lid_motions (L x 2, frames from 1)."""
    recipe = wanted.recipe
    folder = cache_folder() / f"{recipe.name}-{_key(wanted, template)}"
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
        _draw(drawn, scene.paint(recipe, template, neutral, TEXEL_STEP), Path(aside), recipe.name)
        frames = footage.filmed(np.load(Path(aside) / "frames.npy"), recipe)
        footage.encode(frames, whole / made.footage.name, recipe)
        np.savez_compressed(
            whole / made.truth.name,
            vertices=drawn.vertices,
            head_pose=drawn.head_pose,
            intrinsics=drawn.intrinsics,
            lids_shut=motion.values[:, lids] / SHUT,
            lid_motions=np.round(spans).astype(np.int64),
        )
    return made


def _key(wanted: SpeechClip, template: FaceTemplate) -> str:
    """Hash of all that a clip is made of."""
    digest = hashlib.sha256(f"{wanted!r} {BPY_VERSION} {TEXEL_STEP}".encode())
    for array in (template.vertices, template.identity_modes, template.unit_modes):
        rounded = np.round(np.asarray(array, np.float64), 6) + 0.0
        digest.update(np.ascontiguousarray(rounded).tobytes())
    sources = Path(__file__).resolve().parent.parent
    for name in DRAWN_WITH:
        digest.update((sources / f"{name}.py").read_bytes())
    return digest.hexdigest()[:16]
