# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the abused clips beside their clean ones, and keeps them while their inputs stand."""

from __future__ import annotations

import hashlib
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from imageio_ffmpeg import get_ffmpeg_exe
from mimetic.score.truth import Truth
from mimetic.template.face_template import FaceTemplate

from .. import footage
from ..clips import cache_folder, clip
from ..recipes import ALL, Recipe
from .composites import abused
from .recipes import SECONDS, AbuseClip, Source

HERE = Path(__file__).resolve().parent
FOOTAGE = HERE.parents[2] / "build" / "footage"
SOURCES = ("abuse/composites", "abuse/films", "abuse/recipes", "footage", "heads/hand", "noise")


@dataclass(frozen=True)
class MadeClip:
    clip: AbuseClip
    footage: Path
    clean: Path
    # .npz: clean, gone (N, bool), shift (N x 2, pixels); of a drawn head its head_pose (N x 4 x 4,
    # camera from head) without the abuse
    truth: Path


def abused_clip(
    wanted: AbuseClip, template: FaceTemplate, report: Callable[[str], None]
) -> MadeClip:
    """The clip, made if missing. Raises OSError where the real footage was not fetched."""
    paths = [_path_of(one, template, report) for one in (wanted.source, wanted.other)]
    digest = hashlib.sha256(repr(wanted.source).encode() + repr(wanted.other).encode())
    for name in SOURCES:
        digest.update((HERE.parent / f"{name}.py").read_bytes())
    for path in paths:
        digest.update(path.read_bytes())
    folder = cache_folder() / f"abuse-{wanted.source.name}-{digest.hexdigest()[:16]}"
    made = MadeClip(
        wanted,
        folder / f"{wanted.source.name}-{wanted.kind}.mp4",
        folder / f"{wanted.source.name}-clean.mp4",
        folder / f"{wanted.source.name}-{wanted.kind}.npz",
    )
    if not (made.footage.exists() and made.clean.exists() and made.truth.exists()):
        folder.mkdir(parents=True, exist_ok=True)
        report(f"{made.footage.stem}: compositing")
        with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".abuse.") as aside:
            poses = _true_poses(wanted.source, template, report)
            _make(wanted, paths, poses, made, Path(aside))
            for path in (made.clean, made.truth, made.footage):
                (Path(aside) / path.name).replace(path)
    return made


def _path_of(source: Source, template: FaceTemplate, report: Callable[[str], None]) -> Path:
    if source.rendered:
        return clip(ALL[source.footage], template, report).footage
    path = FOOTAGE / source.footage
    if not path.exists():
        raise OSError(f"{path} is missing: run ./scripts/fetch_footage")
    return path


def _true_poses(
    source: Source, template: FaceTemplate, report: Callable[[str], None]
) -> dict[str, np.ndarray]:
    """`head_pose` of a drawn head, frame by frame of the clip; nothing is known of real ones."""
    if not source.rendered:
        return {}
    poses = Truth.load(clip(ALL[source.footage], template, report).truth).head_pose
    return {"head_pose": poses[source.first - 1 :][_order(source.num_frames, source)]}


def _make(
    wanted: AbuseClip,
    paths: list[Path],
    poses: dict[str, np.ndarray],
    made: MadeClip,
    folder: Path,
) -> None:
    source, other = wanted.source, wanted.other
    frames = _frames(paths[0], source)
    in_between = _placed(_frames(paths[1], other), other, source)
    done = abused(wanted, frames, in_between)
    recipe = Recipe("abuse", "still", 0, len(frames), fps=source.fps, crf=17)
    footage.encode(frames, folder / made.clean.name, recipe)
    footage.encode(done.frames, folder / made.footage.name, recipe)
    known = {"clean": done.clean, "gone": done.gone, "shift": done.shift} | poses
    np.savez(folder / made.truth.name, **known)


def _frames(path: Path, source: Source) -> np.ndarray:
    """N x H x W x 3 uint8, so many as the clip's seconds ask for: to and fro where too few."""
    width, height = source.image_size
    last = source.first + source.num_frames - 1
    command = [get_ffmpeg_exe(), "-loglevel", "error", "-i", str(path), "-fps_mode", "passthrough"]
    command += ["-vf", f"select=between(n\\,{source.first - 1}\\,{last - 1})"]
    command += ["-pix_fmt", "rgb24", "-f", "rawvideo", "-"]
    done = subprocess.run(command, capture_output=True, check=False)
    if done.returncode != 0:
        raise OSError(f"ffmpeg could not read {path}: {done.stderr.decode().strip()}")
    frames = np.frombuffer(done.stdout, np.uint8).reshape(-1, height, width, 3)
    return frames[_order(len(frames), source)]


def _order(num_frames: int, source: Source) -> np.ndarray:
    """Indices of the frames as they are shown: to and fro where there are too few."""
    there_and_back = np.concatenate([np.arange(num_frames), np.arange(num_frames - 2, 0, -1)])
    return np.resize(there_and_back, round(SECONDS * source.fps))


def _placed(frames: np.ndarray, shown: Source, source: Source) -> np.ndarray:
    """`shown`'s frames with the face as large as `source`'s and where that is, edges drawn out."""
    width, height = source.image_size
    scale = shown.face[2] / source.face[2]
    columns = _places(width, scale, source.face[0], shown.face[0], shown.image_size[0])
    rows = _places(height, scale, source.face[1], shown.face[1], shown.image_size[1])
    count = round(SECONDS * source.fps)
    placed = np.empty((count, height, width, 3), np.uint8)
    for i in range(count):
        frame = frames[i % len(frames)].astype(np.float32)
        low, share = columns.astype(int), (columns % 1)[None, :, None]
        frame = (1 - share) * frame[:, low] + share * frame[
            :, np.minimum(low + 1, frame.shape[1] - 1)
        ]
        low, share = rows.astype(int), (rows % 1)[:, None, None]
        frame = (1 - share) * frame[low] + share * frame[np.minimum(low + 1, frame.shape[0] - 1)]
        placed[i] = np.round(frame)
    return placed


def _places(length: int, scale: float, to: float, middle: float, available: int) -> np.ndarray:
    return np.clip(middle + scale * (np.arange(length) - to), 0, available - 1)
