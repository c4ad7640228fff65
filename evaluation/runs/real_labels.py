# SPDX-License-Identifier: GPL-3.0-or-later
"""Points marked by hand on real footage: the tables in evaluation/real."""

from __future__ import annotations

import contextlib
import csv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from numpy.typing import NDArray

from evaluation.runs.rendered import CHECKOUT

FOLDER = CHECKOUT / "evaluation" / "real"
CLIPS = ("cap12_edit", "cap13_edit2", "single_face", "franck", "WolfgangLanger_Pexels")
EYE_POINTS = ("eye_outer", "eye_inner", "lid_upper", "lid_lower", "iris")
LIP_POINTS = ("lip_outer_upper", "lip_inner_upper", "lip_inner_lower", "lip_outer_lower")
POINTS = (
    *(f"{point}.{side}" for side in "RL" for point in EYE_POINTS),
    *("mouth_corner.R", "mouth_corner.L", *LIP_POINTS),
)


@dataclass(frozen=True)
class Labels:
    """Of one clip, N frames; what was not marked is nan."""

    clip: str
    frame: NDArray[np.int64]  # N, ascending
    places: NDArray[np.float64]  # N x POINTS x 2, pixels
    touch: NDArray[np.float64]  # N, 1 where the lips touch on the midline, 0 where they do not

    def rows(self, selection: NDArray[np.bool_]) -> Labels:
        return Labels(
            self.clip, self.frame[selection], self.places[selection], self.touch[selection]
        )

    def of(self, *names: str) -> NDArray[np.float64]:
        """N x names x 2."""
        return self.places[:, [POINTS.index(name) for name in names]]

    @property
    def ipd(self) -> NDArray[np.float64]:
        """N, pixels between the middles of the eyes' corners."""
        middles = [self.of(f"eye_outer.{s}", f"eye_inner.{s}").mean(axis=1) for s in "RL"]
        return np.linalg.norm(middles[1] - middles[0], axis=1)


def read_labels(clip: str, second: bool = False) -> Labels | None:
    """The marking of a clip, or the second one, if there is one; raises InvalidInput."""
    path = FOLDER / f"{clip}{'.second' if second else ''}.csv"
    if second and not path.exists():
        return None
    with marking(path) as rows:
        frame = np.array([int(row["frame"]) for row in rows])
        labels = Labels(clip, frame, *marks(rows))
    if len(rows) == 0 or (np.diff(frame) <= 0).any():
        raise InvalidInput(f"{path}: frames must rise from row to row")
    return labels


@contextlib.contextmanager
def marking(path: Path) -> Iterator[list[dict[str, str]]]:
    """The rows of a table; what is wrong in them is raised as InvalidInput."""
    with open(path, newline="", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    try:
        yield rows
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{path}: {error}; evaluation/real/README.md has the columns") from None


def marks(rows: list[dict[str, str]]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """N x POINTS x 2, pixels; N, 1 where lips touch. Raises KeyError, TypeError, ValueError."""
    places = [
        [[_number(row[f"{name}.{axis}"]) for axis in "xy"] for name in POINTS] for row in rows
    ]
    return np.array(places), np.array([_number(row["lips_touch"]) for row in rows])


def footage_of(clip: str) -> Path:
    """The clip itself; raises InvalidInput if it was not fetched."""
    path = CHECKOUT / "build" / "footage" / f"{clip}.mp4"
    if not path.is_file():
        raise InvalidInput(f"{path.name} is not there; run scripts/fetch_footage")
    return path


def _number(text: str) -> float:
    return float(text) if text else np.nan
