# SPDX-License-Identifier: GPL-3.0-or-later
"""A capture that something before the mouth has spoilt, corrected by mouse in a window."""

import shutil
from pathlib import Path

import numpy as np
import spoilt_clip
from matplotlib.image import imread
from mimetic.performance.document import Performance
from mimetic.score.truth import Truth
from mimetic.solve.clip_capture import find_face
from strip_pixels import strip_colours

CORRECTED = (38, 44)
APART = 14  # pixels at least between pins: a nearer click would grab the one that is there


def test_a_spoilt_clip_is_corrected_by_mouse(
    folder, screen, extension, work, pictures, rendered_clip
):
    shutil.copy(extension, work)
    truth = Truth.load(rendered_clip.truth)
    spoilt_clip.cover_mouth(
        rendered_clip.footage, find_face(rendered_clip.footage, 1), work / "spoilt.mp4"
    )
    chosen = apart(truth)
    settings = {
        "extension": extension.name,
        "corrected": CORRECTED,
        "points": truth.tracks[0, chosen].tolist(),
        "true": {frame: truth.tracks[frame - 1, chosen].tolist() for frame in CORRECTED},
    }
    parts, beside = ("walk_corrections.py", work, pictures, settings), ("over_footage.py",)
    result = folder.walk(screen, *parts, seconds=600, beside=beside)
    assert not result.failures()
    assert all(
        is_drawn(result.pictures["corrections-pinned"], pin) for pin in result.arrays["pins"]
    )
    corrected, others = strip_colours(result.pictures["corrections-pinned"], result.arrays["strip"])
    assert "corrected" in corrected and "corrected" not in others, "along the timeline, unbaked"
    captured, refined = (
        Performance.load(work / f"spoilt{take}.performance.npz") for take in ("", ".002")
    )
    places = spoilt_clip.places_of(captured, truth)
    covered = range(spoilt_clip.FIRST, spoilt_clip.LAST + 1)
    before, after = (spoilt_clip.error(take, places, covered) for take in (captured, refined))
    print(f"error under what covers the mouth: {before:.2f} px captured, {after:.2f} px corrected")
    assert before > 2 * after
    steps = {"capture-at-work", "spoilt", "pinned", "refined", "reopened"}
    assert {f"corrections-{step}" for step in steps} <= set(result.pictures)


def is_drawn(picture: Path, pin: list[int]) -> bool:
    """Whether a white dot is at a place of the window, whose rows count from the bottom."""
    pixels = imread(picture)
    x, y = pin[0], len(pixels) - 1 - pin[1]
    return bool((pixels[y - 2 : y + 3, x - 2 : x + 3, :3].min(axis=2) > 0.9).sum() > 8)


def apart(truth: Truth) -> list[int]:
    """Four of the points that move, each away from the others."""
    chosen: list[int] = []
    for k in spoilt_clip.moving_points(truth):
        off = truth.tracks[0, chosen] - truth.tracks[0, k]
        if not len(off) or np.abs(off).max(axis=1).min() > APART:
            chosen.append(int(k))
    assert len(chosen) >= 4
    return chosen[:4]
