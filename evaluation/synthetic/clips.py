# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders clips and their truth, and keeps them in the cache for as long as their inputs stand."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.score.truth import Truth
from mimetic.shared.folder_lock import alone_with
from mimetic.template.face_template import FaceTemplate

from . import footage, scene, surface_points
from .person import neutral_vertices
from .recipes import Recipe

HERE = Path(__file__).resolve().parent
NUM_POINTS = 500
BPY_VERSION = "4.5.15"
# Points nearer to the ears than this share of the nose's depth are not counted as face.
FACE_DEPTH_SHARE = 0.25
Report = Callable[[str], None]


class CannotRender(RuntimeError):
    """What is missing to render, and what to do."""


@dataclass(frozen=True)
class Clip:
    name: str
    footage: Path
    truth: Path


def cache_folder() -> Path:
    """Where rendered clips are kept, outside the checkout."""
    if chosen := os.environ.get("MIMETIC_CACHE"):
        return Path(chosen) / "truth"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "mimetic" / "truth"


def clip(recipe: Recipe, template: FaceTemplate, report: Report = lambda _: None) -> Clip:
    """The clip of a recipe, rendered unless the cache has it."""
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    motion = scene.face_motion(recipe, template, neutral)
    drawn = scene.build(recipe, template, neutral, motion)
    folder = cache_folder() / f"{recipe.name}-{_key(recipe, drawn)}"
    found = Clip(recipe.name, folder / f"{recipe.name}.mp4", folder / f"{recipe.name}.truth.npz")
    if found.footage.exists() and found.truth.exists():
        return found
    folder.parent.mkdir(parents=True, exist_ok=True)
    with (
        alone_with(folder.parent),
        tempfile.TemporaryDirectory(dir=folder.parent, prefix=f".{recipe.name}.") as aside,
    ):
        if found.footage.exists() and found.truth.exists():  # made by another process meanwhile
            return found
        report(f"{recipe.name}: rendering {recipe.num_frames} frames")
        made = Path(aside)
        _render(drawn, scene.paint(recipe, template, neutral), made, recipe.name, report)
        whole = made / "whole"
        whole.mkdir()
        frames = footage.filmed(np.load(made / "frames.npy"), recipe)
        footage.encode(frames, whole / found.footage.name, recipe)
        _truth(recipe, template, drawn, motion, made).save(whole / found.truth.name)
        shutil.rmtree(folder, ignore_errors=True)
        whole.rename(folder)
    return found


def _key(recipe: Recipe, drawn: scene.Scene) -> str:
    """Hash of all that a clip is made of: numbers, recipe, and the code that draws."""
    digest = hashlib.sha256(repr(recipe).encode() + BPY_VERSION.encode())
    for name in sorted(vars(drawn)):
        array = np.ascontiguousarray(getattr(drawn, name))
        if array.dtype.kind == "f":
            # A linear solver's last digits differ between machines; a picture does not.
            array = np.round(array.astype(np.float64), 6) + 0.0
        digest.update(array.tobytes())
    for source in sorted(set(HERE.glob("*.py")) - {HERE / "__main__.py", HERE / "recipes.py"}):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def _render(
    drawn: scene.Scene, textures: dict[str, np.ndarray], folder: Path, name: str, report: Report
) -> None:
    drawn.save(folder / "scene.npz")
    np.savez(folder / "textures.npz", **textures)
    command = [str(blender_python()), str(HERE / "render_frames.py")]
    command += [str(folder / "scene.npz"), str(folder / "textures.npz"), str(folder)]
    environment = os.environ | {"LIBGL_ALWAYS_SOFTWARE": "1"}
    with (folder / "stderr").open("w+") as errors:
        child = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=errors, text=True, env=environment
        )
        last = []
        for line in child.stdout:
            words = line.split()
            if words[:1] == ["frame"] and int(words[1]) % 20 == 0:
                report(f"{name}: frame {words[1]} of {words[2]}")
            last = [*last[-4:], line]
        if child.wait() != 0:
            errors.seek(0)
            raise CannotRender(f"Blender could not draw {name}:\n{''.join(last)}{errors.read()}")


def blender_python() -> Path:
    """A Python that has Blender as a module."""
    if importlib.util.find_spec("bpy"):
        return Path(sys.executable)
    other = cache_folder().parent / f"bpy-{BPY_VERSION}" / "bin" / "python"
    if other.exists():
        return other
    raise CannotRender("the bpy module is missing: run ./scripts/setup")


def _truth(
    recipe: Recipe,
    template: FaceTemplate,
    drawn: scene.Scene,
    motion: scene.Motion,
    folder: Path,
) -> Truth:
    surface = np.load(folder / "surface.npy").astype(np.float64)
    quads = np.load(folder / "quads.npy")
    rest, surface = surface[0], surface[1:]
    on_skin = np.load(folder / "quad_part.npy") == template.part_names.index("skin")
    allowed = on_skin & _on_face(rest[quads].mean(1), recipe, drawn, template)
    points = surface_points.choose(
        surface[0], quads, allowed, drawn.head_pose[0], drawn.intrinsics, NUM_POINTS, recipe.seed
    )
    positions = np.stack([points.positions(s) for s in surface])
    poses = zip(surface, drawn.head_pose, strict=True)
    seen = [surface_points.visible(points, s, quads, p, drawn.intrinsics) for s, p in poses]
    tracks = np.stack(
        [
            surface_points.project(surface_points.in_camera(at, pose), drawn.intrinsics)
            for at, pose in zip(positions, drawn.head_pose, strict=True)
        ]
    )
    inside = ((tracks >= 0) & (tracks <= drawn.image_size - 1)).all(2)
    return Truth(
        frame=np.arange(1, len(surface) + 1),
        fps=recipe.fps,
        image_size=drawn.image_size,
        intrinsics=drawn.intrinsics,
        head_pose=drawn.head_pose,
        points=positions,
        tracks=tracks,
        visible=np.stack(seen) & inside,
        neutral_points=points.positions(rest),
        points_face=points.corners,
        points_bary=points.weights,
        neutral_vertices=drawn.neutral,
        **_controls(recipe, motion),
    )


def _controls(recipe: Recipe, motion: scene.Motion) -> dict:
    """The keys of a truth file that name what moved the face."""
    if recipe.kind == "units":
        return {"units": motion.names, "unit_values": motion.values}
    if recipe.kind == "still":
        return {}
    is_muscle = motion.groups > 0
    chosen = np.array(motion.names)
    return {
        "muscles": chosen[is_muscle],
        "groups": motion.groups[is_muscle],
        "activations": motion.values[:, is_muscle],
        "articulators": chosen[~is_muscle],
        "articulator_values": motion.values[:, ~is_muscle],
    }


def _on_face(
    middles: np.ndarray, recipe: Recipe, drawn: scene.Scene, template: FaceTemplate
) -> np.ndarray:
    """Quads with these middles (Q,3) in front of the ears, above the chin's end, without hair."""
    nose, menton = (drawn.neutral[template.landmark(name)] for name in ("nose_tip", "menton"))
    in_front = middles[:, 2] > FACE_DEPTH_SHARE * nose[2]
    bald = scene.painter(recipe, template, drawn.neutral).hairiness(middles) < 0.05
    return in_front & bald & (middles[:, 1] > menton[1])
