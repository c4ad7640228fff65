# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a set of still images and keeps it in the cache for as long as its inputs stand."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.template.face_template import FaceTemplate

from ..clips import BPY_VERSION, _render, cache_folder
from . import photograph
from .sitters import FACES_A_PERSON, IMAGE_SIZE, PARTS, sitter

# Seeds of people; whoever trains on drawn people takes none from 500 to 799.
SETS = {"held-out": range(500, 520), "tuning": range(40, 60), "small": range(700, 701)}


def stills(name: str, template: FaceTemplate, report: Callable[[str], None]) -> Path:
    """The .npz of a set, drawn unless the cache has it.

    docs/measured/finding-faces.md has its keys.
    """
    path = cache_folder() / f"stills-{name}-{_key(name, template)}.npz"
    if path.exists():
        return path
    rows: list[dict] = []
    for seed in SETS[name]:
        report(f"stills: person {seed - SETS[name][0] + 1} of {len(SETS[name])}")
        rows += _portraits(seed, template, report)
    rows += _empty(rows, SETS[name][0])
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=".stills.") as aside:
        made = Path(aside) / path.name
        np.savez(
            made, parts=np.array(PARTS), **{k: np.stack([r[k] for r in rows]) for k in rows[0]}
        )
        made.replace(path)
    return path


def _portraits(seed: int, template: FaceTemplate, report: Callable[[str], None]) -> list[dict]:
    person = sitter(seed, template)
    with tempfile.TemporaryDirectory() as folder:
        _render(person.scene, person.textures, Path(folder), f"person {seed}", report)
        frames = np.load(Path(folder) / "frames.npy")
    rows = []
    for i, frame in enumerate(frames):
        shot = 10 * seed + i
        left, top = person.crop[i]
        frame = frame[top : top + IMAGE_SIZE[1], left : left + IMAGE_SIZE[0]]
        seen = photograph.photographed(photograph.over(frame, photograph.surroundings(shot)), shot)
        if i < FACES_A_PERSON:
            rows.append(_row(seen, "face", person.places[i], person.ipd[i], person.yaw[i], seed))
        else:
            rows.append(_row(seen, "back of a head", person=seed))
    return rows


def _empty(rows: list[dict], seed: int) -> list[dict]:
    """As many again without a head as there are heads seen from behind, of each of two kinds."""
    faces = [row["images"] for row in rows if row["has_face"]]
    made = []
    for i in range(len(rows) // (FACES_A_PERSON + 1)):
        shot = 10000 + 10 * seed + i
        plain = photograph.surroundings(shot)
        made.append(_row(photograph.photographed(plain, shot), "room" if shot % 2 else "texture"))
        mixed = photograph.jumbled(faces[i * FACES_A_PERSON], shot)
        made.append(_row(mixed, "jumbled face"))
    return made


def _row(image: np.ndarray, kind: str, places=None, ipd=np.nan, yaw=np.nan, person=-1) -> dict:
    return {
        "images": image,
        "has_face": np.bool_(places is not None),
        "kinds": np.str_(kind),
        "places": np.full((len(PARTS), 2), np.nan) if places is None else places,
        "ipd": np.float64(ipd),
        "yaw": np.float64(yaw),
        "person": np.int64(person),
    }


def _key(name: str, template: FaceTemplate) -> str:
    """Hash of all that the set is made of: template, seeds and the code that draws."""
    digest = hashlib.sha256(f"{name} {SETS[name]} {IMAGE_SIZE} {BPY_VERSION}".encode())
    for array in (template.vertices, template.identity_modes, template.unit_modes):
        rounded = np.round(np.asarray(array, np.float64), 6) + 0.0
        digest.update(np.ascontiguousarray(rounded).tobytes())
    here = Path(__file__).resolve().parent
    for folder in (here, here.parent):
        for source in sorted(set(folder.glob("*.py")) - {here.parent / "__main__.py"}):
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]
