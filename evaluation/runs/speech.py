# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate speech`: lips that meet and lids that wink, of rendered people who speak."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from mimetic.fit.face_model import limit_positions
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.shared.array_file import read_archive
from mimetic.solve.clip_capture import capture
from mimetic.template.face_template import FaceTemplate, load_template
from numpy.typing import NDArray

from evaluation.runs.head_clips import face_mesh_python
from evaluation.runs.real_events import NEAR, Range, runs
from evaluation.runs.real_labels import POINTS, Labels
from evaluation.runs.real_methods import (
    IRISES,
    ON_SKIN,
    REFINED_MESH_POINTS,
    by_capture,
    head_points,
    iris_fronts,
    run_face_mesh,
)
from evaluation.runs.real_score import APART, lips_gap, score_places
from evaluation.runs.rendered import render

SETS = ("held-out", "tuning", "small")
OURS, FACE_MESH = "capture", "MediaPipe, refined"
CELL = 15
WINKING, WIDE_OPEN = 0.3, 0.05  # share of the lids' way: an eye that winks, and the other one
SHAPES = {
    "vertices": ("N", "V", 3),
    "head_pose": ("N", 4, 4),
    "intrinsics": (3, 3),
    "lids_shut": ("N", 2),
    "lid_motions": ("L", 2),
}
MOST = {"N": 10_000, "V": 100_000, "L": 100}
BLINK, HALF = 2, 3  # of the motions of the lids, after two winks
COLUMNS = {
    "met": ("lips meet, F1", ".2f"),
    "told": ("told", ".2f"),
    "outer lips": ("outer lips", ".1f"),
    "inner lips": ("inner lips", ".1f"),
    "mouth corners": ("mouth corners", ".1f"),
    "lids": ("lids", ".1f"),
    "winks": ("wink", ".2f"),
    "other": ("other lid", ".2f"),
    "blink": ("blink", ".2f"),
    "half": ("half a blink", ".2f"),
    "muscle": ("muscle", ".2f"),
}


@dataclass(frozen=True)
class SpeechScore:
    """Of one method on one clip. met: lips' contacts in truth, in the method's, and of both."""

    name: str
    head: str
    method: str
    figures: dict[str, float]
    met: tuple[int, int, int]


def score_speech(which: str, report: Callable[[str], None]) -> Iterator[list[SpeechScore]]:
    """Clip by clip of a set, rendered now if the cache lacks them. Raises InvalidInput."""
    output = render(["--speech", which], "the clips could not be rendered", report)
    python = face_mesh_python(report)
    for line in output.splitlines():
        head, name, footage, truth_path = line.split("\t")
        truth = read_archive(Path(truth_path), SHAPES, {"lid_motions": "i"}, MOST)
        report(f"{name}: capturing")
        labels = labels_of(name, truth, load_template())
        scores = [score_capture(labels, head, capture(footage), truth)]
        if python is not None:
            meshes = run_face_mesh(Footage(footage), python)
            places = meshes[:, [REFINED_MESH_POINTS[point] for point in POINTS]]
            figures, met = lip_figures(labels, FACE_MESH, places)
            scores.append(SpeechScore(name, head, FACE_MESH, figures, met))
        yield scores


def labels_of(name: str, truth: dict[str, NDArray], template: FaceTemplate) -> Labels:
    """The points that are marked by hand on real faces, of a drawn one, in every frame."""
    on_limit, skin = limit_positions(template), template.num_skin_vertices
    at = head_points(template)
    irises = iris_fronts(truth["vertices"][0].astype(np.float64), template)  # they look ahead
    places = np.empty((len(truth["vertices"]), len(POINTS), 2))
    for row, (vertices, pose) in enumerate(
        zip(truth["vertices"].astype(np.float64), truth["head_pose"], strict=True)
    ):
        points = np.empty((len(POINTS), 3))
        points[ON_SKIN] = on_limit(vertices[:skin])[at]
        points[IRISES] = irises
        seen = (points @ pose[:3, :3].T + pose[:3, 3]) @ truth["intrinsics"].T
        places[row] = seen[:, :2] / seen[:, 2:]
    labels = Labels(name, np.arange(1, len(places) + 1), places, np.full(len(places), np.nan))
    return replace(labels, touch=(lips_gap(labels, places) < APART).astype(np.float64))


def score_capture(
    labels: Labels, head: str, performance: Performance, truth: dict[str, NDArray]
) -> SpeechScore:
    """truth: lids_shut (N x 2), lid_motions (L x 2). Raises InvalidInput."""
    if len(performance.frame) != len(labels.frame):
        raise InvalidInput(f"{labels.clip}: a performance of the whole clip is needed")
    figures, met = lip_figures(labels, OURS, by_capture(labels, performance))
    names = list(performance.articulators)
    lids = performance.articulator_values[:, [names.index(f"lid_upper.{side}") for side in "LR"]]
    figures |= lid_figures(lids, truth)
    moved = np.concatenate([performance.activations[span] for span in _spans(truth)])
    figures["muscle"] = float(moved.max())
    return SpeechScore(labels.clip, head, OURS, figures, met)


def _spans(truth: dict[str, NDArray]) -> list[slice]:
    """Rows of the motions of the lids."""
    return [slice(first - 1, last) for first, last in truth["lid_motions"]]


def lid_figures(lids: NDArray[np.float64], truth: dict[str, NDArray]) -> dict[str, float]:
    """Of captured lids (N x 2, left first, 1 where shut): winks, the other eye's, and blinks."""
    spans = _spans(truth)
    winks, others = [], []
    for span in spans[:BLINK]:
        for eye in (0, 1):
            if truth["lids_shut"][span, eye].max() > WINKING:
                winks.append(lids[span, eye].max())
            elif truth["lids_shut"][span, eye].max() < WIDE_OPEN:
                others.append(lids[span, eye].max())
    return {
        "winks": float(min(winks)),
        "other": float(max(others)),
        "blink": float(lids[spans[BLINK]].max(axis=0).min()),
        "half": float(lids[spans[HALF]].max(axis=0).mean()),
    }


def lip_figures(
    labels: Labels, method: str, places: NDArray[np.float64]
) -> tuple[dict[str, float], tuple[int, int, int]]:
    score = score_places(labels, method, places)
    figures = {name: one["median"] for name, one in score.figures.items() if one}
    shown, seen = labels.touch > 0.5, lips_gap(labels, places) < APART
    figures["told"] = float((shown == seen).mean())
    true, own = runs(labels.frame, shown), runs(labels.frame, seen)
    met = (len(true), len(own), _alike(true, own))
    return figures | {"met": f1(met)}, met


def _alike(true: list[Range], own: list[Range]) -> int:
    """How many begin and end where one of the others does, NEAR allowed."""
    return sum(any(abs(a - c) <= NEAR and abs(b - d) <= NEAR for c, d in own) for a, b in true)


def f1(met: tuple[int, int, int]) -> float:
    true, own, both = met
    return 2 * both / max(1, true + own)


def figures(scores: list[SpeechScore]) -> dict[str, dict[str, float]]:
    """By the head's motion and for all: medians; of winks, blinks and muscles the worst clip's."""
    rows = {}
    heads = [*dict.fromkeys(score.head for score in scores), None]
    for head in heads:
        for method in (OURS, FACE_MESH):
            own = [s for s in scores if s.method == method and head in (None, s.head)]
            if own:
                rows[f"{f'head {head}' if head else 'all'}: {method}"] = _together(own)
    return rows


def _together(scores: list[SpeechScore]) -> dict[str, float]:
    worst = {"winks": min, "other": max, "blink": min, "muscle": max}
    row = {}
    for key in COLUMNS:
        values = [score.figures[key] for score in scores if key in score.figures]
        if values:
            row[key] = float(worst.get(key, np.median)(values))
    row["told"] = float(np.mean([score.figures["told"] for score in scores]))
    row["met"] = f1(tuple(sum(counts) for counts in zip(*(s.met for s in scores), strict=True)))
    return row


def clip_text(scores: list[SpeechScore]) -> str:
    rows = {score.method: score.figures for score in scores}
    return text_table(f"{scores[0].name}, head {scores[0].head}", COLUMNS, rows, CELL)


def as_text(scores: list[SpeechScore]) -> str:
    return text_table("together", COLUMNS, figures(scores), CELL)


def as_json(scores: list[SpeechScore]) -> str:
    clips = [
        {"name": s.name, "head": s.head, "method": s.method, **s.figures, "contacts": s.met}
        for s in scores
    ]
    return json_text({"together": figures(scores), "clips": clips})
