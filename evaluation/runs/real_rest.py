# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate rest --set real`: the frame taken as rest in parts of real clips, beside how
much at rest a person found their frames."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from mimetic import InvalidInput
from mimetic.fit.fitting import NoFace
from mimetic.media.footage import Footage
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.solve.clip_capture import rest_in

from evaluation.runs.real_labels import FOLDER, footage_of, marking

CLIPS = ("franck",)
AT_REST = 2  # rated; 1: nearly, 0: not
COLUMNS = {
    "parts": ("parts", "d"),
    "at_rest": ("at rest", ".2f"),
    "nearly": ("nearly", ".2f"),
    "not": ("not", ".2f"),
    "missed": ("missed", ".2f"),
    "chance": ("by chance", ".2f"),
}
RATED = ("rating", "best", "mean")


@dataclass(frozen=True)
class Part:
    """Of a clip: its first and last frame, and the ratings of some of its frames."""

    clip: str
    first: int
    last: int
    ratings: dict[int, int]


@dataclass(frozen=True)
class RealRest:
    """Of one part: the frame that was taken, its rating, the best one there is, their mean."""

    name: str
    frame: int  # 0 where no face was found
    rating: int
    best: int
    mean: float


def read_parts(clip: str) -> list[Part]:
    """In their order in the table. Raises InvalidInput."""
    path = FOLDER / f"{clip}.rest.csv"
    parts: dict[tuple[int, int], dict[int, int]] = {}
    with marking(path) as rows:
        for row in rows:
            first, last, frame, rating = (int(row[n]) for n in ("first", "last", "frame", "rest"))
            if not (first <= frame <= last and 0 <= rating <= AT_REST):
                raise ValueError(f"frame {frame} is outside of its part, or its rating of 0 to 2")
            parts.setdefault((first, last), {})[frame] = rating
    if not parts:
        raise InvalidInput(f"{path} has no rows")
    return [Part(clip, *span, ratings) for span, ratings in parts.items()]


def score_rest(which: str, report: Callable[[str], None]) -> list[RealRest]:
    """Of all parts. Raises InvalidInput if a clip was not fetched. which: \"real\"."""
    scores = []
    for clip in CLIPS:
        footage = Footage(footage_of(clip))
        for part in read_parts(clip):
            report(f"{clip}: frames {part.first} to {part.last}")
            try:
                frame = rest_in(footage, (part.first, part.last)).fit.frame
            except NoFace:
                frame = 0
            scores.append(scored(part, frame))
    return scores


def scored(part: Part, frame: int) -> RealRest:
    """frame: 0 for none. One that is not rated counts as the nearest that is."""
    nearest = min(part.ratings, key=lambda rated: abs(rated - frame))
    values = part.ratings.values()
    name = f"{part.clip} {part.first} to {part.last}"
    rating = part.ratings[nearest] if frame else 0
    return RealRest(name, frame, rating, max(values), sum(values) / len(values))


def figures(scores: list[RealRest]) -> dict[str, float]:
    """COLUMNS of all parts."""
    ratings, best, means = (np.array([getattr(s, n) for s in scores]) for n in RATED)
    shares = {name: float((ratings == k).mean()) for k, name in enumerate(("not", "nearly"))}
    return {
        "parts": len(scores),
        "at_rest": float((ratings == AT_REST).mean()),
        **shares,
        "missed": float((best - ratings).mean()),
        "chance": float((best - means).mean()),
    }


def as_text(scores: list[RealRest]) -> str:
    each = "\n".join(f"{s.name}: frame {s.frame}, rated {s.rating} of {s.best}" for s in scores)
    title = "rating of the frame taken as rest; missed: by how much the best frame's is higher"
    return f"{each}\n\n{text_table(title, COLUMNS, {'all': figures(scores)}, 10)}"


def as_json(scores: list[RealRest]) -> str:
    return json_text({"all": figures(scores), "parts": [vars(score) for score in scores]})
