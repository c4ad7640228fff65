# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate rest`: how often the frame chosen from a short clip shows the face at rest."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.fit.fitting import NoFace
from mimetic.media.footage import Footage
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.shared.array_file import read_archive
from mimetic.solve.clip_capture import rest_in

from evaluation.runs.rendered import render

AT_REST = 0.1  # of a face unit: what moves less is hardly seen
COLUMNS = {
    "clips": ("clips", "d"),
    "at_rest": ("at rest", ".2f"),
    "median": ("median", ".2f"),
    "p90": ("90 %", ".2f"),
    "worst": ("worst", ".2f"),
    "chance": ("by chance", ".2f"),
}


@dataclass(frozen=True)
class RestScore:
    """Of one clip: the frame that was chosen, and how far the face is from rest in it."""

    kind: str
    name: str
    frame: int  # 0 where no face was found
    moved: float  # the largest value of a face unit, 0 to 1
    share: float  # of the clip's frames that are at rest


def score_rest(which: str, report=None) -> list[RestScore]:
    """The clips of a set, rendered now if the cache lacks them."""
    output = render(["--rest", which], "the clips could not be rendered", report)
    return [_score(*line.split("\t")) for line in output.splitlines()]


def _score(kind: str, name: str, footage: str, truth: str) -> RestScore:
    shapes = {"unit_values": ("N", "U")}
    units = read_archive(Path(truth), shapes, {}, {"N": 10_000, "U": 1000})["unit_values"]
    movement = units.max(axis=1)
    share = float((movement < AT_REST).mean())
    try:
        frame = rest_in(Footage(footage), (1, len(movement))).fit.frame
    except NoFace:
        return RestScore(kind, name, 0, 1.0, share)
    return RestScore(kind, name, frame, float(movement[frame - 1]), share)


def figures(scores: list[RestScore]) -> dict[str, dict[str, float]]:
    """By kind of clip, and of all: columns of COLUMNS."""
    rows = {}
    for kind in [*dict.fromkeys(score.kind for score in scores), "all"]:
        of_kind = [score for score in scores if kind in ("all", score.kind)]
        movement = np.array([score.moved for score in of_kind])
        rows[kind] = {
            "clips": len(of_kind),
            "at_rest": float((movement < AT_REST).mean()),
            "median": float(np.median(movement)),
            "p90": float(np.quantile(movement, 0.9)),
            "worst": float(movement.max()),
            "chance": float(np.mean([score.share for score in of_kind])),
        }
    return rows


def as_text(scores: list[RestScore]) -> str:
    each = "\n".join(f"{one.name}: frame {one.frame}, {one.moved:.2f}" for one in scores)
    title = f"largest face unit in the frame chosen; at rest: below {AT_REST}"
    return f"{each}\n\n{text_table(title, COLUMNS, figures(scores), 10)}"


def as_json(scores: list[RestScore]) -> str:
    return json_text({"kinds": figures(scores), "clips": [vars(score) for score in scores]})
