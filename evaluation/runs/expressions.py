# SPDX-License-Identifier: GPL-3.0-or-later
"""Many people, some expressions each: `mimetic evaluate --set full`, scored by expression."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.score import scores
from mimetic.score.groups import group_curves
from mimetic.score.truth import Truth
from mimetic.solve import clip_capture
from numpy.typing import NDArray

from evaluation.baselines.paper_loop import capture_by_loop
from evaluation.runs import deviation
from evaluation.runs.curves import correlations, timing_errors
from evaluation.runs.deviation import Explained
from evaluation.runs.drift import Drift, drift_of
from evaluation.runs.methods import LOOP, MUSCLES, OURS, Motion, of_performance, peers
from evaluation.runs.own_process import process_pool
from evaluation.runs.rendered import Clip, clips, render

SETS = ("full", "full-swung", "full-tuning", "lips-and-air", "lips-and-air-tuning")
AXES = ("pitch_deg", "yaw_deg", "roll_deg")
Report = Callable[[str], None]


@dataclass(frozen=True)
class Take:
    """A clip of one person. kind: what moves the face; head: how it moves."""

    clip: Clip
    kind: str
    head: str


@dataclass(frozen=True)
class ShownExpression:
    """One expression by one person: every method's errors in its frames, ready to be pooled."""

    expression: str
    take: str
    kind: str
    head: str
    image: dict[str, Explained]  # pixels
    space: dict[str, Explained]  # millimetres
    figures: dict[str, list[float]] = field(default_factory=dict)  # name -> values to pool


def takes(which: str, people: int | None, report: Report) -> tuple[list[Take], Take]:
    """The clips of a set, or of so many of its people, and its long one; rendered if missing."""
    arguments = ["--expressions", which, *([] if people is None else ["--people", str(people)])]
    output = render(arguments, "the clips could not be rendered", report)
    rows = [line.split("\t") for line in output.splitlines()]
    clips = [Take(Clip(r[2], Path(r[3]), Path(r[4])), r[0], r[1]) for r in rows]
    return [take for take in clips if take.kind != "long"], clips[-1]


def clips_of(which: str, people: int | None, report: Report) -> list[Clip]:
    """The clips of any set that captures are scored on, without the long one."""
    if which not in SETS:
        return clips(which, report)
    return [take.clip for take in takes(which, people, report)[0]]


def score_take(take: Take, mesh_python: Path | None) -> list[ShownExpression]:
    """Every method on one clip."""
    fit = clip_capture.find_face(take.clip.footage)
    ours = clip_capture.capture(take.clip.footage, fit=fit)
    loop = capture_by_loop(take.clip.footage, fit=fit)
    truth = seen_at_start(Truth.load(take.clip.truth))
    start = truth.tracks[0]
    images = [image for _, image in Footage(take.clip.footage)]
    motions = {
        OURS: of_performance(ours, start),
        MUSCLES: of_performance(ours.without_detail(), start),
        LOOP: of_performance(loop, start),
        f"{LOOP}, muscles": of_performance(loop.without_detail(), start),
        **peers(ours, images, start, mesh_python),
    }
    return shown_expressions(take, truth, motions)


def shown_expressions(
    take: Take, truth: Truth, motions: dict[str, Motion]
) -> list[ShownExpression]:
    image = {name: deviation.in_image(truth, motion) for name, motion in motions.items()}
    space = {
        name: deviation.in_space(truth, motion)
        for name, motion in motions.items()
        if motion.points is not None
    }
    expressions = []
    for name, (first, last) in zip(truth.expressions, truth.expression_frames, strict=True):
        rows = slice(*np.searchsorted(truth.frame, (first, last + 1)))
        expression = ShownExpression(
            *(name, take.clip.name, take.kind, take.head),
            {method: Explained.of(one, rows) for method, one in image.items()},
            {method: Explained.of(one, rows) for method, one in space.items()},
        )
        for method, motion in motions.items():
            if motion.performance is not None:
                _figures(expression, truth, motion.performance, method, rows)
        expressions.append(expression)
    return expressions


def _figures(
    expression: ShownExpression, truth: Truth, performance: Performance, method: str, rows: slice
) -> None:
    """Figures of a performance beside its surface, under "method: figure"."""

    def put(name: str, values: list[float]) -> None:
        expression.figures[f"{method}: {name}"] = values

    curves = group_curves(truth, performance)
    put("correlation", correlations(curves, rows))
    for name, values in timing_errors(curves, rows).items():
        put(name, values)
    head_turns = scores.head_errors(truth.head_pose, performance.head_pose)
    put("pose", np.abs(head_turns[rows]).ravel().tolist())
    std = np.sqrt(np.diagonal(performance.head_pose_cov, axis1=1, axis2=2)[:, :3])
    both = np.degrees(np.hypot(std, std[0]))
    put("pose held", _held(head_turns[rows], both[rows]))
    if truth.activations is not None:
        order = [truth.muscles.index(name) for name in performance.muscles]
        error = performance.activations - truth.activations[:, order]
        put("held", _held(error[rows], performance.activations_std[rows]))
        is_moving = truth.activations[rows][:, order].max(0) > scores.ACTIVE
        std = performance.activations_std[rows]
        put("held, active", _held(error[rows][:, is_moving], std[:, is_moving]))
        silent = truth.activations[:, order].max(0) < scores.SILENT
        put("false", performance.activations[rows][:, silent].max(0).tolist())


def _held(error: NDArray, std: NDArray) -> list[float]:
    """1 for each value that its own 90 % interval holds, 0 for the others."""
    return (np.abs(error) <= scores.INTERVAL_90 * std).astype(float).ravel().tolist()


def seen_at_start(truth: Truth) -> Truth:
    """The truth's points that are visible in the first frame, where a method is shown them."""
    is_visible = truth.visible[0]
    return replace(
        truth,
        points=truth.points[:, is_visible],
        tracks=truth.tracks[:, is_visible],
        visible=truth.visible[:, is_visible],
        neutral_points=None,
        points_face=None,
        points_bary=None,
    )


def score_set(
    clips: list[Take], long: Take, mesh_python: Path | None, report: Report, jobs: int
) -> tuple[list[ShownExpression], dict[str, Drift]]:
    """Every expression of the takes and the long one's drift, `jobs` of them at once."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    expressions: list[ShownExpression] = []
    with process_pool(jobs) as pool:
        drifts = pool.submit(long_drift, long)  # the longest first
        waiting = [pool.submit(score_take, take, mesh_python) for take in clips]
        for number, (take, result) in enumerate(zip(clips, waiting, strict=True)):
            expressions += result.result()
            report(f"{take.clip.name}: {number + 1} of {len(clips)}")
        return expressions, drifts.result()


def long_drift(take: Take) -> dict[str, Drift]:
    """Ours and the paper's loop over a thousand frames with a return to neutral in between."""
    fit = clip_capture.find_face(take.clip.footage)
    truth = Truth.load(take.clip.truth)
    return {
        OURS: drift_of(truth, clip_capture.capture(take.clip.footage, fit=fit)),
        LOOP: drift_of(truth, capture_by_loop(take.clip.footage, fit=fit)),
    }
