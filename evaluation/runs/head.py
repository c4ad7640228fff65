# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate head`: ways to follow a head side by side on sequences with known poses."""

from __future__ import annotations

import math
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.shared.whole_file import whole_file

from evaluation.runs.head_clips import face_mesh_python, head_clips, score_clip
from evaluation.runs.head_score import AXES, HeadScore

CLIP_COLUMNS = {
    "pitch_mean": ("pitch", ".2f"),
    "yaw_mean": ("yaw", ".2f"),
    "roll_mean": ("roll", ".2f"),
    "mean": ("mean", ".2f"),
    "median": ("median", ".2f"),
    "pitch_p95": ("pitch 95%", ".2f"),
    "yaw_p95": ("yaw 95%", ".2f"),
    "roll_p95": ("roll 95%", ".2f"),
    "translation": ("transl. %", ".2f"),
    "lost": ("lost", ".0f"),
    "drift": ("drift", ".2f"),
    "jitter": ("jitter", ".3f"),
    "ms": ("ms", ".2f"),
    "first_pass_ms": ("first pass", ".2f"),
}
SUMMARY_COLUMNS = {
    "mean": ("mean", ".2f"),
    "mean_to_45": ("yaw to 45", ".2f"),
    "sweep": ("sweeps", ".2f"),
    "third": ("third rate", ".2f"),
    "median": ("median", ".2f"),
    "translation": ("transl. %", ".2f"),
    "lost": ("lost", ".0f"),
    "drift": ("drift", ".2f"),
    "jitter": ("jitter", ".3f"),
    "ms": ("ms", ".2f"),
    "first_pass_ms": ("first pass", ".2f"),
}
CELL = 11  # letters a column: there are many
FULL_RATE = ("real", "sweep", "long", "compression", "hand", "light", "expressions", "speed")


def score_heads(which: str, report, with_face_mesh: bool = True):
    """Scores (HeadScore) clip by clip of a rendered set; raises InvalidInput."""
    clips = head_clips(which, report)
    face_mesh = face_mesh_python(report) if with_face_mesh else None
    for clip in clips:
        yield list(score_clip(clip, face_mesh, report))


def clip_text(scores: list[HeadScore]) -> str:
    """One clip: errors in degrees over frames with a pose, each axis's mean and 95th percentile.

    ms: of a frame, all passes over the clip together; and of the first one alone.
    """
    title = f"{scores[0].clip} ({scores[0].figures['frames']:.0f} frames)"
    return text_table(title, CLIP_COLUMNS, {score.method: score.figures for score in scores}, CELL)


def summary(scores: list[HeadScore]) -> dict[str, dict[str, float]]:
    """By method, over all clips: each clip counts alike, frames lost are added up."""
    summaries = {}
    for method in dict.fromkeys(score.method for score in scores):
        rows = [score for score in scores if score.method == method]
        full = [row for row in rows if row.kind in FULL_RATE]
        moving = [row for row in rows if row.kind != "still"]
        summaries[method] = {
            "mean": _mean(moving, "mean"),
            "mean_to_45": _mean(full, "mean_to_45"),
            "sweep": _mean([row for row in rows if row.kind == "sweep"], "mean"),
            "third": _mean([row for row in rows if row.kind == "third"], "mean"),
            "median": _mean(moving, "median"),
            "translation": _mean(moving, "translation"),
            "lost": sum(row.figures["lost"] for row in rows),
            "drift": _mean(rows, "drift"),
            "jitter": _mean(rows, "jitter"),
            "ms": float(np.median([row.figures["ms"] for row in rows])),
            "first_pass_ms": float(np.median([row.figures["first_pass_ms"] for row in rows])),
        }
    return summaries


def summary_text(scores: list[HeadScore]) -> str:
    return text_table("all clips", SUMMARY_COLUMNS, summary(scores), CELL)


def as_json(scores: list[HeadScore]) -> str:
    """Figures by clip and method, and the summary; what is undefined is null."""
    clips: dict[str, dict] = {}
    for score in scores:
        row = {"kind": score.kind, **score.figures}
        clips.setdefault(score.clip, {})[score.method] = row
    return json_text({"summary": summary(scores), "clips": clips})


def write(scores: list[HeadScore], folder: Path) -> None:
    """head.json, head_errors.png and head_angles.png, each whole or not at all; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    with whole_file(folder / "head.json") as stream:
        stream.write(f"{as_json(scores)}\n".encode())
    with whole_file(folder / "head_errors.png") as stream:
        _plot_errors(scores, stream)
    with whole_file(folder / "head_angles.png") as stream:
        _plot_angles(scores, stream)


def _plot_errors(scores: list[HeadScore], stream: BinaryIO) -> None:
    """Mean error by clip, a bar for each method."""
    from matplotlib.figure import Figure

    clips = list(dict.fromkeys(score.clip for score in scores))
    methods = list(dict.fromkeys(score.method for score in scores))
    figure = Figure(figsize=(5 + 0.7 * len(clips), 4), layout="constrained")
    axes = figure.subplots()
    width = 0.8 / len(methods)
    for k, method in enumerate(methods):
        errors = {s.clip: s.figures["mean"] for s in scores if s.method == method}
        at = np.arange(len(clips)) + (k - (len(methods) - 1) / 2) * width
        axes.bar(at, [errors.get(clip, math.nan) for clip in clips], width, label=method)
    axes.set_xticks(np.arange(len(clips)), clips, rotation=30, ha="right", fontsize=8)
    axes.set_yscale("log")
    axes.axhline(1, color="0.5", linewidth=0.8)
    axes.set_ylabel("mean error over the axes, degrees")
    axes.legend(fontsize=8, ncols=len(methods))
    figure.savefig(stream, format="png", dpi=120)


def _plot_angles(scores: list[HeadScore], stream: BinaryIO) -> None:
    """Pitch, yaw and roll over time in the first sweep, as the paper's Fig. 16."""
    from matplotlib.figure import Figure

    swept = next((s.clip for s in scores if s.kind == "sweep"), scores[0].clip)
    of_sweep = [score for score in scores if score.clip == swept]
    figure = Figure(figsize=(9, 7), layout="constrained")
    panels = figure.subplots(3, 1, sharex=True)
    for axis, (name, panel) in enumerate(zip(AXES, panels, strict=True)):
        panel.plot(of_sweep[0].true_angles[:, axis], color="black", linewidth=2.5, label="truth")
        for score in of_sweep:
            panel.plot(score.angles[:, axis], linewidth=1, label=score.method)
        panel.set_ylabel(f"{name}, degrees")
        panel.grid(alpha=0.3)
    panels[0].legend(fontsize=8, ncols=len(of_sweep) + 1)
    panels[0].set_title(swept, fontsize=10)
    panels[-1].set_xlabel("frame")
    figure.savefig(stream, format="png", dpi=120)


def _mean(scores: list[HeadScore], name: str) -> float:
    numbers = [s.figures[name] for s in scores if math.isfinite(s.figures.get(name, math.nan))]
    return float(np.mean(numbers)) if numbers else math.nan
