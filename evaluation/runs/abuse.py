# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate abuse`: faces that are covered, cut away, dissolved or in the dark."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic.fit.face_fit import FaceFit
from mimetic.head.tracking import track_head
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY, Performance
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.solve import clip_capture
from numpy.typing import NDArray

from evaluation.runs.abuse_score import AbuseTruth, score_abuse
from evaluation.runs.rendered import render

Report = Callable[[str], None]
COLUMNS = {
    "touched": ("touched", ".0f"),
    "wrong": ("wrong", ".0f"),
    "worst": ("worst deg", ".1f"),
    "lost": ("lost", ".0f"),
    "back": ("back s", ".2f"),
}
# What follows the face: the capture, and the head alone as users get it
METHODS: dict[str, Callable[[Path, FaceFit], Performance]] = {
    "capture": lambda footage, fit: clip_capture.capture(footage, fit=fit),
    "head": lambda footage, fit: track_head(footage, fit=fit),
}


@dataclass(frozen=True)
class AbuseClip:
    kind: str
    source: str
    later: bool  # the reference frame lies after the abuse
    footage: Path
    clean_footage: Path
    truth: Path

    @property
    def name(self) -> str:
        return f"{self.kind}, from behind" if self.later else self.kind


@dataclass(frozen=True)
class AbuseScore:
    clip: str
    source: str
    method: str
    figures: dict[str, float]


def abuse_clips(which: str, report: Report) -> list[AbuseClip]:
    """The clips of a set, made now if the cache lacks them; raises InvalidInput."""
    output = render(["--abuse", which], "the abused clips could not be made", report)
    rows = (line.split("\t") for line in output.splitlines())
    return [
        AbuseClip(kind, source, side == "later", *map(Path, paths))
        for kind, source, side, *paths in rows
    ]


def score_set(which: str, report: Report) -> Iterator[list[AbuseScore]]:
    """Scores source by source."""
    clips = abuse_clips(which, report)
    for source in dict.fromkeys(clip.source for clip in clips):
        yield list(_score_source([clip for clip in clips if clip.source == source], report))


def _score_source(clips: list[AbuseClip], report: Report) -> Iterator[AbuseScore]:
    fits: dict[bool, FaceFit] = {}
    performances: dict[tuple[str, bool], Performance] = {}
    for clip in clips:
        with np.load(clip.truth, allow_pickle=False) as truth:
            clean, is_gone, shift = truth["clean"], truth["gone"], truth["shift"]
            true_poses = truth.get("head_pose")
        if clip.later not in fits:
            fits[clip.later] = _fit_aside(clip)
        fit = fits[clip.later]
        for method, follow in METHODS.items():
            report(f"{clip.source}, {clip.name}: {method}")
            if (method, clip.later) not in performances:
                performances[method, clip.later] = follow(clip.clean_footage, fit)
            right = performances[method, clip.later]
            performance = follow(clip.footage, fit)
            poses = right.head_pose if true_poses is None else laid_on(true_poses, fit)
            about = AbuseTruth(poses, clean, is_gone, shift, performance.fps, clip.later)
            figures = score_abuse(about, performance.head_pose, performance.quality, fit.intrinsics)
            figures["lost"] -= float(np.sum(clean & (right.quality < HELD_QUALITY)))
            yield AbuseScore(clip.name, clip.source, method, figures)


def laid_on(true_poses: NDArray[np.float64], fit: FaceFit) -> NDArray[np.float64]:
    """N x 4 x 4: how a fitted head moves that moves as the true one does since the fit's frame."""
    since = true_poses @ np.linalg.inv(true_poses[fit.frame - 1])
    return since @ fit.head_pose


def _fit_aside(clip: AbuseClip) -> FaceFit:
    """The person as the frames before, or after, the abuse show them."""
    count = Footage(clip.clean_footage).num_frames
    third = count // 3
    frames = (count - third + 1, count) if clip.later else (1, third)
    return clip_capture.find_face(clip.clean_footage, frames=frames)


def as_text(scores: list[AbuseScore]) -> str:
    """A table for each method, a row a clip, and what they come to."""
    tables = []
    for method in dict.fromkeys(score.method for score in scores):
        rows = {f"{s.source}, {s.clip}": s.figures for s in scores if s.method == method}
        tables.append(text_table(method, COLUMNS, rows | {"all": total(list(rows.values()))}))
    return "\n\n".join(tables)


def total(rows: list[dict[str, float]]) -> dict[str, float]:
    """Frames are added up; of degrees and seconds the worst."""
    sums = {name: sum(row[name] for row in rows) for name in ("touched", "wrong", "lost")}
    return sums | {
        name: float(np.nanmax([row[name] for row in rows])) for name in ("worst", "back")
    }


def as_json(scores: list[AbuseScore]) -> str:
    """Figures by method, source and kind; what never came is null."""
    document: dict[str, dict] = {}
    for score in scores:
        document.setdefault(score.method, {}).setdefault(score.source, {})[score.clip] = (
            score.figures
        )
    return json_text(document)
