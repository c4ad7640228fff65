# SPDX-License-Identifier: GPL-3.0-or-later
"""What a page of many takes shows of one: a picture, and how well it was captured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.report.overlay import FaceDrawing
from mimetic.shared.results import PERFORMANCE
from mimetic.shared.whole_file import whole_file

PICTURE = "picture.jpg"
WIDTH = 400  # pixels
MOST_POINTS = 120  # of the curve of quality


def summarise(folder: Path, clip: Path) -> dict[str, Any]:
    """Quality of the performance in a folder, for task.json; writes the picture beside it.

    Raises what reading performance and clip raises, and OSError.
    """
    performance = Performance.load(folder / PERFORMANCE)
    quality = performance.quality
    shown_index = _telling_index(performance)
    _write_picture(performance, Footage(clip), shown_index, folder / PICTURE)
    parts = np.array_split(quality, min(MOST_POINTS, len(quality)))
    return {
        "frames": [int(performance.frame[0]), int(performance.frame[-1])],
        "num_held": int((quality < HELD_QUALITY).sum()),
        "median": round(float(np.median(quality)), 3),
        "lowest": round(float(quality.min()), 3),
        "curve": [round(float(part.min()), 3) for part in parts],
        "shown": int(performance.frame[shown_index]),
        "notes": list(performance.notes or ()),
    }


def _telling_index(performance: Performance) -> int:
    """Of the frames that are captured well, the one in which most muscles are at work."""
    effort = performance.activations.sum(axis=1)
    is_good = performance.quality >= np.median(performance.quality)
    return int(np.argmax(np.where(is_good, effort, -1.0)))


def _write_picture(performance: Performance, footage: Footage, i: int, path: Path) -> None:
    from PIL import Image  # comes with matplotlib

    image = footage.read(int(performance.frame[i]))
    picture = Image.fromarray(FaceDrawing(performance).paint(image, i))
    picture.thumbnail((WIDTH, WIDTH))
    with whole_file(path) as stream:
        picture.save(stream, "jpeg", quality=85)


def is_summary(value: object) -> bool:
    """Whether a value from a file is what `summarise` gives, or {} for none."""
    if not isinstance(value, dict) or not value:
        return value == {}
    numbers = [value.get(name) for name in ("num_held", "median", "lowest", "shown")]
    lists = [value.get("frames"), value.get("curve")]
    if not all(isinstance(one, list) for one in lists) or len(lists[0] or ()) != 2:
        return False
    numbers += [*(lists[0] or ()), *(lists[1] or ())]
    notes = value.get("notes")
    return (
        all(isinstance(one, int | float) for one in numbers)
        and isinstance(notes, list)
        and all(isinstance(note, str) for note in notes)
    )
