# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders takes and writes their truth, and keeps both in the cache while their inputs stand."""

from __future__ import annotations

import hashlib
import os
import subprocess
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
from mimetic.score.truth import Truth
from mimetic.template.face_template import FaceTemplate

from .. import footage, scene
from ..clips import BPY_VERSION, CannotRender, Clip, _truth, blender_python, cache_folder
from ..heads.films import _aside, _to_and_fro
from ..person import neutral_vertices
from ..recipes import Recipe
from .recipes import Take
from .simulation import simulated_motion

SOURCES = ("motion", "noise", "person", "render_frames", "scene", "texture", "footage")
DRAWING = "expressions/draw_frames"
SIMULATED_BY = ("muscles.toml", "materials.toml")
TEXEL_STEP = 2  # half the texture's size is finer than the picture still
LONG_FRAMES = 1080


def take_clip(take: Take, template: FaceTemplate, report: Callable[[str], None]) -> Clip:
    """The clip of a take, rendered unless the cache has it."""
    folder = _rendered(take, template, report)
    name = take.recipe.name
    return Clip(name, folder / f"{name}.mp4", folder / f"{name}.truth.npz")


def long_clip(take: Take, template: FaceTemplate, report: Callable[[str], None]) -> Clip:
    """A take played to and fro for over a thousand frames, each with noise of its own."""
    folder = _rendered(take, template, report)
    name = f"{take.recipe.name}-long"
    made = Clip(name, folder / "long" / f"{name}.mp4", folder / "long" / f"{name}.truth.npz")
    if made.footage.exists() and made.truth.exists():
        return made
    report(f"{name}: encoding {LONG_FRAMES} frames")
    truth = Truth.load(folder / f"{take.recipe.name}.truth.npz")
    order = _to_and_fro(len(truth.frame), LONG_FRAMES)
    rows = ("points", "tracks", "visible", "head_pose", "unit_values", "activations")
    rows += ("articulator_values",)
    changed = {key: getattr(truth, key)[order] for key in rows if getattr(truth, key) is not None}
    long = replace(
        truth,
        frame=np.arange(1, LONG_FRAMES + 1),
        expressions=None,
        expression_frames=None,
        **changed,
    )
    with _aside(folder / "long") as whole:
        frames = np.load(folder / "frames.npz", allow_pickle=False)["frames"][order]
        footage.encode(footage.filmed(frames, take.recipe), whole / made.footage.name, take.recipe)
        long.save(whole / made.truth.name)
    return made


def _rendered(take: Take, template: FaceTemplate, report: Callable[[str], None]) -> Path:
    """The folder of a take: footage, truth, and the frames before the camera spoilt them."""
    recipe = take.recipe
    folder = cache_folder() / f"expressions-{recipe.name}-{_key(take, template)}"
    if (folder / f"{recipe.name}.truth.npz").exists():
        return folder
    report(f"{recipe.name}: {', '.join(take.expressions)}")
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    simulated = recipe.kind == "muscles"
    motion = (simulated_motion if simulated else scene.face_motion)(recipe, template, neutral)
    drawn = scene.build(recipe, template, neutral, motion)
    intrinsics = drawn.intrinsics.copy()
    intrinsics[:2, 2] += recipe.image_size[0] * np.array(take.camera_error)
    drawn = replace(drawn, intrinsics=intrinsics)
    with _aside(folder) as whole, tempfile.TemporaryDirectory() as aside:
        made = Path(aside)
        paint = scene.paint(recipe, template, neutral, TEXEL_STEP)
        _draw(drawn, paint, made, recipe.name)
        frames = np.load(made / "frames.npy")
        np.savez_compressed(whole / "frames.npz", frames=frames)
        footage.encode(footage.filmed(frames, recipe), whole / f"{recipe.name}.mp4", recipe)
        truth = _truth(recipe, template, drawn, motion, made)
        truth = replace(
            truth, expressions=list(take.expressions), expression_frames=np.array(take.spans())
        )
        truth.save(whole / f"{recipe.name}.truth.npz")
    return folder


def _draw(drawn: scene.Scene, textures: dict[str, np.ndarray], folder: Path, name: str) -> None:
    """frames.npy and the drawn surface (`render_frames`) into the folder."""
    drawn.save(folder / "scene.npz")
    np.savez(folder / "textures.npz", **textures)
    script = Path(__file__).resolve().parent / "draw_frames.py"
    command = [blender_python(), script, folder / "scene.npz", folder / "textures.npz", folder]
    done = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1"},
    )
    if done.returncode != 0:
        raise CannotRender(f"Blender could not draw {name}:\n{done.stderr[-1000:]}")


def film(
    drawn: scene.Scene, recipe: Recipe, template: FaceTemplate, made: Path, path: Path
) -> None:
    """Draws a scene, with what the renderer writes in the folder `made`, and films it as `path`."""
    _draw(drawn, scene.paint(recipe, template, drawn.neutral, TEXEL_STEP), made, recipe.name)
    footage.encode(footage.filmed(np.load(made / "frames.npy"), recipe), path, recipe)


def film_key(
    what: str, arrays: Iterable[np.ndarray], sources: Iterable[str], data: Iterable[str] = ()
) -> str:
    """Hash of all that a film is made of: who does what, and the code that moves and draws.

    arrays: numbers beside; sources: modules of `evaluation.synthetic`; data: files of the package's
    """
    digest = hashlib.sha256(f"{what} {BPY_VERSION} {TEXEL_STEP}".encode())
    for array in arrays:
        rounded = np.round(np.asarray(array, np.float64), 6) + 0.0
        digest.update(np.ascontiguousarray(rounded).tobytes())
    folder = Path(__file__).resolve().parent.parent
    for name in sources:
        digest.update((folder / f"{name}.py").read_bytes())
    for name in data:
        digest.update((resources.files("mimetic") / "data" / name).read_bytes())
    return digest.hexdigest()[:16]


def _key(take: Take, template: FaceTemplate) -> str:
    simulated = take.recipe.kind == "muscles"
    return film_key(
        repr(take),
        (template.vertices, template.identity_modes, template.unit_modes),
        (DRAWING, *SOURCES, *(("expressions/simulation",) if simulated else ())),
        SIMULATED_BY if simulated else (),
    )
