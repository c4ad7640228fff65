# SPDX-License-Identifier: GPL-3.0-or-later
"""Photographs and frames of footage, with the faces of real_faces.csv in them, or none.

Places in real_faces.csv were proposed by the finder that has cascades alone, and every one was
looked at. Footage comes from scripts/fetch_footage; photographs from scikit-image's wheel (NASA's
Eileen Collins, and pictures without a person) and matplotlib's (Grace Hopper, U.S. Navy).
"""

from __future__ import annotations

import csv
import hashlib
import io
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from mimetic.media.footage import Footage
from PIL import Image

from ..clips import cache_folder
from ..stills.sitters import PARTS

ROOT = Path(__file__).resolve().parents[3]
LIST = Path(__file__).with_name("real_faces.csv")
SIZE = (640, 640)  # width, height: smaller pictures lie in its left top
EMPTY = ("chelsea.png", "text.png", "page.png", "retina.jpg", "motorcycle_right.png")
ASTRONAUT, HOPPER = "astronaut.png", "grace_hopper.jpg"


def real_stills(report: Callable[[str], None]) -> Path:
    """The .npz of real pictures, collected unless the cache has it."""
    digest = hashlib.sha256(LIST.read_bytes() + Path(__file__).read_bytes()).hexdigest()[:16]
    path = cache_folder() / f"stills-real-{digest}.npz"
    if path.exists():
        return path
    report("stills: fetching footage and photographs")
    subprocess.run(
        [sys.executable, ROOT / "scripts" / "fetch_footage"], check=True, stdout=sys.stderr
    )
    rows = [_row(picture, "photograph") for picture in _photographs(EMPTY).values()]
    listed: dict[str, dict[int, np.ndarray]] = {}
    with LIST.open(encoding="utf-8", newline="") as stream:
        for source, frame, *numbers in list(csv.reader(stream))[1:]:
            places = np.array(numbers, float).reshape(len(PARTS), 2)
            listed.setdefault(source, {})[int(frame)] = places
    portraits = _portraits()
    for source, faces in listed.items():
        if source in portraits:
            rows.append(_row(portraits[source], source, faces[0]))
            continue
        footage = Footage(ROOT / "build" / "footage" / source)
        for frame, picture in footage.frames(1, max(faces)):
            if frame in faces:
                rows.append(_row(picture, source, faces[frame]))
    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_name(f".{path.name}")
    np.savez(aside, parts=np.array(PARTS), **{k: np.stack([r[k] for r in rows]) for k in rows[0]})
    aside.replace(path)
    return path


def _photographs(names: tuple[str, ...]) -> dict[str, np.ndarray]:
    sys.path.insert(0, str(ROOT / "scripts" / "build"))
    from eigenspaces.natural import wheel

    with zipfile.ZipFile(wheel(cache_folder().parent / "eigenspaces")) as archive:
        files = {name: archive.read(f"skimage/data/{name}") for name in names}
    return {name: _rgb(io.BytesIO(content)) for name, content in files.items()}


def _portraits() -> dict[str, np.ndarray]:
    import matplotlib.cbook

    hopper = matplotlib.cbook.get_sample_data(HOPPER, asfileobj=False)
    return _photographs((ASTRONAUT,)) | {HOPPER: _rgb(hopper)}


def _rgb(file) -> np.ndarray:
    return np.asarray(Image.open(file).convert("RGB"))


def _row(picture: np.ndarray, kind: str, places: np.ndarray | None = None) -> dict:
    framed = np.zeros((SIZE[1], SIZE[0], 3), np.uint8)
    picture = picture[: SIZE[1], : SIZE[0]]
    framed[: picture.shape[0], : picture.shape[1]] = picture
    known = places is not None
    return {
        "images": framed,
        "has_face": np.bool_(known),
        "kinds": np.str_(kind),
        "places": places if known else np.full((len(PARTS), 2), np.nan),
        # As seen: how far the heads are turned is not known
        "ipd": np.float64(np.linalg.norm(places[0] - places[1]) if known else np.nan),
        "yaw": np.float64(np.nan),
    }
