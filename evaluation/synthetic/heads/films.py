# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders films, shows them as clips, and keeps both in the cache while their inputs stand."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .. import footage, scene
from ..clips import BPY_VERSION, _render, cache_folder
from ..person import neutral_vertices
from ..recipes import Recipe
from .hand import covered
from .recipes import FACE_WIDTH, HeadClip

DRAWN_WITH = ("motion", "noise", "person", "render_frames", "scene", "texture")
SHOWN_WITH = ("footage", "noise", "heads/films", "heads/hand")


@dataclass(frozen=True)
class MadeClip:
    clip: HeadClip
    footage: Path
    truth: Path


def head_clip(clip: HeadClip, template: FaceTemplate, report: Callable[[str], None]) -> MadeClip:
    """The clip and its truth, made if missing: head_pose N x 4 x 4, intrinsics, image_size, fps."""
    film = _film(clip.film, template, report)
    digest = hashlib.sha256(f"{clip!r} {film.name}".encode())
    folder = cache_folder() / f"headclip-{clip.name}-{_with_sources(digest, SHOWN_WITH)}"
    made = MadeClip(clip, folder / f"{clip.name}.mp4", folder / f"{clip.name}.head.npz")
    if not (made.footage.exists() and made.truth.exists()):
        with _aside(folder) as whole:
            _show(clip, np.load(film / "film.npz"), whole / made.footage.name, whole)
    return made


def _film(recipe: Recipe, template: FaceTemplate, report: Callable[[str], None]) -> Path:
    """A folder with the rendered frames and their poses in film.npz."""
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), recipe.seed)
    drawn = scene.build(recipe, template, neutral, scene.face_motion(recipe, template, neutral))
    digest = hashlib.sha256(f"{recipe!r} {BPY_VERSION}".encode())
    for name in sorted(vars(drawn)):
        array = np.ascontiguousarray(getattr(drawn, name))
        if array.dtype.kind == "f":
            # A linear solver's last digits differ between machines; a picture does not.
            array = np.round(array.astype(np.float64), 6) + 0.0
        digest.update(array.tobytes())
    folder = cache_folder() / f"{recipe.name}-{_with_sources(digest, DRAWN_WITH)}"
    if not (folder / "film.npz").exists():
        report(f"{recipe.name}: rendering {recipe.num_frames} frames")
        with _aside(folder) as whole, tempfile.TemporaryDirectory() as made:
            paint = scene.paint(recipe, template, neutral)
            _render(drawn, paint, Path(made), recipe.name, report)
            np.savez_compressed(
                whole / "film.npz",
                frames=np.load(Path(made) / "frames.npy"),
                head_pose=drawn.head_pose,
                intrinsics=drawn.intrinsics,
            )
    return folder


def _show(clip: HeadClip, film, path: Path, folder: Path) -> None:
    frames, poses = film["frames"], film["head_pose"]
    order = _to_and_fro(len(frames), clip.num_frames or len(frames))[:: clip.step]
    frames, poses = frames[order], poses[order]
    intrinsics, fps = film["intrinsics"], clip.film.fps / clip.step
    if clip.hand:
        at = intrinsics @ poses[0, :3, 3]
        times = np.arange(len(frames)) / fps
        frames = covered(frames, times, at[:2] / at[2], FACE_WIDTH, clip.film.seed)
    shown = replace(clip.film, fps=round(fps), crf=clip.crf, noise_sd=clip.noise_sd)
    footage.encode(footage.filmed(frames, shown), path, shown)
    np.savez(
        folder / f"{clip.name}.head.npz",
        head_pose=poses,
        intrinsics=intrinsics,
        image_size=np.array(clip.film.image_size),
        fps=np.array([fps]),
    )


def _to_and_fro(length: int, wanted: int) -> np.ndarray:
    if length == 1:
        return np.zeros(wanted, int)
    there_and_back = np.concatenate([np.arange(length), np.arange(length - 2, 0, -1)])
    return np.resize(there_and_back, wanted)


def _with_sources(digest, names: tuple[str, ...]) -> str:
    sources = Path(__file__).resolve().parent.parent
    for name in names:
        digest.update((sources / f"{name}.py").read_bytes())
    return digest.hexdigest()[:16]


@contextmanager
def _aside(folder: Path) -> Iterator[Path]:
    """A folder beside `folder` that takes its place when all went well."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".head.") as made:
        whole = Path(made) / "whole"
        whole.mkdir()
        yield whole
        shutil.rmtree(folder, ignore_errors=True)
        whole.rename(folder)
