# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a set of portraits and keeps it in the cache for as long as its inputs stand."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from .. import footage, scene
from ..clips import BPY_VERSION, _render, cache_folder
from ..motion import rotation
from ..person import neutral_vertices
from ..recipes import Recipe
from ..stills.sitters import toward_light

# Seeds of people. Nobody else has them: clips end at 102, stills have 40 to 59 and 500 to 799,
# eigenspaces are trained on people from 1000 on, landmarks from 2000 on.
SETS = {"held-out": range(300, 330), "tuning": range(200, 212), "small": range(220, 221)}
SHOTS = ((0.0, 8.0), (10.0, 20.0), (20.0, 30.0))  # least and largest yaw, degrees, to either side
LARGEST_PITCH, LARGEST_ROLL = 12.0, 6.0  # degrees
FACE_WIDTHS = (100.0, 120.0)  # pixels
FOCAL_RATIOS = (0.9, 1.5)  # focal length over image width


def portraits(name: str, template: FaceTemplate, report: Callable[[str], None]) -> Path:
    """The .npz of a set, drawn unless the cache has it (docs/measured/fitting.md has its keys)."""
    path = cache_folder() / f"portraits-{name}-{_key(name, template)}.npz"
    if path.exists():
        return path
    rows: list[dict] = []
    for number, seed in enumerate(SETS[name]):
        report(f"portraits: person {number + 1} of {len(SETS[name])}")
        rows += _shots(seed, number, template, report)
    people = {row["person"].item(): row.pop("neutral") for row in rows}
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".portraits.") as aside:
        made = Path(aside) / path.name
        np.savez(
            made,
            neutral_vertices=np.stack([people[number] for number in sorted(people)]),
            **{k: np.stack([r[k] for r in rows]) for k in rows[0]},
        )
        made.replace(path)
    return path


def _shots(seed: int, number: int, template: FaceTemplate, report) -> list[dict]:
    rng = np.random.default_rng([seed, 81])
    recipe = Recipe("still", "still", seed, len(SHOTS), focal_ratio=rng.uniform(*FOCAL_RATIOS))
    neutral = neutral_vertices(template, scene.identity_of(recipe, template), seed)
    drawn = scene.build(recipe, template, neutral, scene.face_motion(recipe, template, neutral))
    focal = drawn.intrinsics[0, 0]
    distance = focal * scene.FACE_WIDTH / rng.uniform(*FACE_WIDTHS)
    poses, yaws, pitches = zip(*(_pose(rng, yaw, distance) for yaw in SHOTS), strict=True)
    light = [*toward_light(rng), rng.uniform(0.7, 1.25)]
    drawn = replace(drawn, head_pose=np.stack(poses), light=np.tile(light, (len(SHOTS), 1)))
    with tempfile.TemporaryDirectory() as folder:
        textures = scene.paint(recipe, template, neutral, step=2)
        _render(drawn, textures, Path(folder), f"person {seed}", report)
        images = footage.filmed(np.load(Path(folder) / "frames.npy"), recipe)
    return [
        {
            "images": image,
            "person": np.int64(number),
            "head_pose": pose,
            "intrinsics": drawn.intrinsics,
            "yaw": np.float64(yaw),
            "pitch": np.float64(pitch),
            "neutral": neutral,
        }
        for image, pose, yaw, pitch in zip(images, poses, yaws, pitches, strict=True)
    ]


def _pose(rng: np.random.Generator, yaws, distance: float) -> tuple[np.ndarray, float, float]:
    """camera_from_head (4,4), yaw and pitch in degrees."""
    yaw = rng.choice((-1, 1)) * rng.uniform(*yaws)
    pitch, roll = rng.uniform(-1, 1, 2) * (LARGEST_PITCH, LARGEST_ROLL)
    pose = np.eye(4)
    pose[:3, :3] = np.diag((1, -1, -1)) @ rotation(*np.radians([yaw, pitch, roll]))
    pose[:3, 3] = (*rng.uniform(-0.02, 0.02, 2), distance * rng.uniform(0.95, 1.05))
    return pose, yaw, pitch


def _key(name: str, template: FaceTemplate) -> str:
    """Hash of all that the set is made of: template, seeds and the code that draws."""
    digest = hashlib.sha256(f"{name} {SETS[name]} {BPY_VERSION}".encode())
    for array in (template.vertices, template.identity_modes):
        rounded = np.round(np.asarray(array, np.float64), 6) + 0.0
        digest.update(np.ascontiguousarray(rounded).tobytes())
    here = Path(__file__).resolve().parent
    drawn_by = [here.parent / "stills" / "sitters.py", here / "portrait_set.py"]
    drawn_by += [here.parent / f"{n}.py" for n in ("footage", "motion", "noise", "person")]
    drawn_by += [here.parent / f"{n}.py" for n in ("render_frames", "scene", "texture")]
    for source in drawn_by:
        digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
