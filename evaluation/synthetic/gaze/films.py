# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders people who look about, and keeps the clips while their inputs stand."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic import _core
from mimetic.muscles.articulators import EyeLids, eye_frames
from mimetic.muscles.eyeballs import eye_geometry
from mimetic.skin.mesh import SkinMesh
from mimetic.template.face_template import FaceTemplate

from .. import scene
from ..clips import Clip, cache_folder
from ..expressions.films import DRAWING, SOURCES, film, film_key
from ..heads.films import _aside
from ..person import neutral_vertices
from .recipes import GazeClip

DRAWN_WITH = (*SOURCES, DRAWING, "gaze/films")


def gaze_clip(wanted: GazeClip, template: FaceTemplate, report: Callable[[str], None]) -> Clip:
    """The clip, rendered unless the cache has it. Its truth: gaze (N x 4, degrees), iris_pixels
    (N x 2 x 2, left first), corner_pixels (N x 2 x 2 x 2, each eye's outer and inner corner)."""
    recipe = wanted.recipe
    gaze = wanted.angles()
    numbers = (template.vertices, template.identity_modes, gaze)
    folder = cache_folder() / f"{recipe.name}-{film_key(repr(wanted), numbers, DRAWN_WITH)}"
    made = Clip(recipe.name, folder / f"{recipe.name}.mp4", folder / f"{recipe.name}.gaze.npz")
    if made.footage.exists() and made.truth.exists():
        return made
    report(f"{recipe.name}: rendering {recipe.num_frames} frames")
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    moved = _moved(neutral, template, gaze)
    motion = scene.Motion([], np.zeros((len(gaze), 0)), np.zeros(0, int), moved - neutral)
    drawn = scene.build(recipe, template, neutral, motion)
    with _aside(folder) as whole, tempfile.TemporaryDirectory() as aside:
        film(drawn, recipe, template, Path(aside), whole / made.footage.name)
        np.savez(
            whole / made.truth.name, gaze=gaze, **_pixels(drawn, template, neutral, gaze, moved)
        )
    return made


def _moved(neutral: np.ndarray, template: FaceTemplate, gaze: np.ndarray) -> np.ndarray:
    """N x V x 3: eyeballs turned, lids gone along."""
    eyes = eye_geometry(neutral, template)
    lids = [EyeLids(frame) for frame in eye_frames(SkinMesh(template, neutral))]
    rows = []
    for angles in gaze:
        vertices = _core.turned_eyeballs(neutral, eyes.eye_of_vertex, eyes.centers, angles)
        for eye, lid in enumerate(lids):
            down = _core.Gaze(np.array([1.0, 0.0, 0.0]), -np.radians(angles[2 * eye + 1]))
            vertices = vertices + lid.turn(_core.lid_angle(lid, down))
        rows.append(vertices)
    return np.stack(rows)


def _pixels(
    drawn: scene.Scene,
    template: FaceTemplate,
    neutral: np.ndarray,
    gaze: np.ndarray,
    moved: np.ndarray,
) -> dict[str, np.ndarray]:
    eyes = eye_geometry(neutral, template)
    names = [[f"eye_{end}.{side}" for end in ("outer", "inner")] for side in "LR"]
    corners = np.array([[template.landmark(name) for name in pair] for pair in names])
    irises, ends = [], []
    for angles, vertices, pose in zip(gaze, moved, drawn.head_pose, strict=True):
        fronts = np.array([_core.gaze_direction(*angles[2 * eye : 2 * eye + 2]) for eye in (0, 1)])
        middles = eyes.centers + eyes.radii[:, None] * fronts
        irises.append(_projected(middles, pose, drawn.intrinsics))
        ends.append(_projected(vertices[corners], pose, drawn.intrinsics))
    return {"iris_pixels": np.stack(irises), "corner_pixels": np.stack(ends)}


def _projected(points: np.ndarray, pose: np.ndarray, intrinsics: np.ndarray) -> np.ndarray:
    seen = (points @ pose[:3, :3].T + pose[:3, 3]) @ intrinsics.T
    return seen[..., :2] / seen[..., 2:]
