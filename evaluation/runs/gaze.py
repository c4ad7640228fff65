# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate gaze`: where rendered people look, and what that does to head and muscles."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.performance.gaze import gaze_of, has_gaze, iris_circles
from mimetic.score.json_text import json_text
from mimetic.score.scores import INTERVAL_90
from mimetic.score.text_table import text_table
from mimetic.shared.array_file import read_archive
from mimetic.solve.clip_capture import capture
from numpy.typing import NDArray

from evaluation.runs.head_clips import face_mesh_python
from evaluation.runs.real_methods import run_face_mesh
from evaluation.runs.rendered import render

FAR = 25.0  # degrees
SETS = ("held-out", "tuning", "small")
OURS, FACE_MESH = "capture", "MediaPipe, refined"
# Of its landmarks: irises, outer and inner corners, the left first
IRISES, CORNERS = (473, 468), ((263, 362), (33, 133))
SHAPES = {
    "gaze": ("N", 4),
    "iris_pixels": ("N", 2, 2),
    "corner_pixels": ("N", 2, 2, 2),
}
COLUMNS = {
    "gaze": ("gaze, degrees", ".1f"),
    "gaze_p90": ("90 %", ".1f"),
    "known": ("bias known", ".1f"),
    "iris": ("iris, % IPD", ".1f"),
    "inside": ("in 90 % bars", ".2f"),
    "muscle": ("largest muscle", ".2f"),
    "head": ("head, degrees", ".2f"),
}


@dataclass(frozen=True)
class GazeScore:
    """Of one method on one clip; degrees, % of the interpupillary distance."""

    name: str
    kind: str
    method: str
    figures: dict[str, float]
    errors: NDArray[np.float64]  # N x 2, degrees, of each eye's direction
    remainders: NDArray[np.float64]  # the same, with the clip's mean error of each angle taken away


def score_gaze(which: str, report: Callable[[str], None]) -> Iterator[list[GazeScore]]:
    """Clip by clip of a set, rendered now if the cache lacks them. Raises InvalidInput."""
    output = render(["--gaze", which], "the clips could not be rendered", report)
    python = face_mesh_python(report)
    for line in output.splitlines():
        eye_px, head, gaze, name, footage, truth_path = line.split("\t")
        truth = read_archive(Path(truth_path), SHAPES, {}, {"N": 10_000})
        report(f"{name}: capturing")
        kind = f"eyes {float(eye_px):.0f} px, head {head}"
        scores = [score_capture(name, kind, capture(footage), truth, head == "still")]
        if python is not None and gaze == "saccades":
            scores.append(_score_face_mesh(name, kind, Footage(footage), python, truth))
        yield scores


def score_capture(
    name: str,
    kind: str,
    performance: Performance,
    truth: dict[str, NDArray],
    is_still: bool = False,
) -> GazeScore:
    """truth: gaze (N x 4), iris_pixels (N x 2 x 2), corner_pixels; is_still: the head keeps still.

    Raises InvalidInput.
    """
    if not has_gaze(performance):
        raise InvalidInput(f"{name}: the performance has no gaze; are the networks installed?")
    rows = performance.frame - 1
    angles = gaze_of(performance)
    irises = np.stack([_irises(performance, i) for i in range(performance.num_frames)])
    bars = INTERVAL_90 * performance.articulator_values_std[:, -4:]
    inside = np.abs(angles - truth["gaze"][rows]) <= bars
    figures = {
        **_iris_figures(irises, truth, rows),
        "inside": float(inside.mean()),
        "muscle": float(performance.activations.max()),
        "head": _head_moved(performance, truth["gaze"][rows]) if is_still else np.nan,
    }
    return _score(name, kind, OURS, angles, truth["gaze"][rows], figures)


def _head_moved(performance: Performance, gaze: NDArray[np.float64]) -> float:
    """Degrees by which the captured head turns as the eyes turn by FAR, on the mean of the clip."""
    angles = np.degrees(performance.head_pose[:, [2, 2, 1], [1, 0, 0]])  # about x, y, z if small
    ways = np.column_stack([np.ones(len(gaze)), gaze[:, :2]])
    return float(FAR * np.abs(np.linalg.lstsq(ways, angles, rcond=None)[0][1:]).max())


def _score_face_mesh(
    name: str, kind: str, footage: Footage, python: Path, truth: dict[str, NDArray]
) -> GazeScore:
    """Its irises; gaze by where they are between the corners of their eye, in proportion.

    It gives no angles. The line from place to angle, and its zero, are the best for this very
    clip's truth, which nobody who uses it has.
    """
    meshes = run_face_mesh(footage, python)
    angles = np.full((len(meshes), 4), np.nan)
    for eye, (iris, corners) in enumerate(zip(IRISES, CORNERS, strict=True)):
        ends = meshes[:, list(corners)]
        along = ends[:, 0] - ends[:, 1] if eye == 0 else ends[:, 1] - ends[:, 0]
        width = np.linalg.norm(along, axis=1, keepdims=True)
        along = along / width
        off = (meshes[:, iris] - ends.mean(axis=1)) / width
        across = np.stack([along[:, 1], -along[:, 0]], axis=1)  # upwards
        for axis, way in enumerate((along, across)):
            place = (off * way).sum(axis=1)
            column = 2 * eye + axis
            is_seen = np.isfinite(place)
            if is_seen.sum() > 2:
                line = np.polyfit(place[is_seen], truth["gaze"][is_seen, column], 1)
                angles[:, column] = np.polyval(line, place)
    rows = np.arange(len(meshes))
    figures = _iris_figures(meshes[:, list(IRISES)], truth, rows)
    return _score(name, kind, FACE_MESH, angles, truth["gaze"], figures)


def _irises(performance: Performance, i: int) -> NDArray[np.float64]:
    pose = performance.head_pose[i]
    return performance.project(iris_circles(performance, i)[:, 0] @ pose[:3, :3].T + pose[:3, 3])


def _iris_figures(
    irises: NDArray[np.float64], truth: dict[str, NDArray], rows: NDArray[np.int64]
) -> dict[str, float]:
    corners = truth["corner_pixels"][rows].mean(axis=2)
    ipd = np.linalg.norm(corners[:, 0] - corners[:, 1], axis=1)
    off = np.linalg.norm(irises - truth["iris_pixels"][rows], axis=2)
    return {"iris": float(100 * np.nanmedian(off / ipd[:, None]))}


def _score(
    name: str,
    kind: str,
    method: str,
    angles: NDArray[np.float64],
    truth: NDArray[np.float64],
    figures: dict[str, float],
) -> GazeScore:
    errors = _angles_between(angles, truth)
    remainders = _angles_between(angles - np.nanmean(angles - truth, axis=0), truth)
    figures |= {
        "gaze": float(np.nanmedian(errors)),
        "gaze_p90": float(np.nanquantile(errors, 0.9)),
        "known": float(np.nanmedian(remainders)),
    }
    return GazeScore(name, kind, method, figures, errors, remainders)


def _angles_between(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """N x 2 degrees between the directions of N x 4 angles."""
    a, b = (_directions(angles) for angles in (one, other))
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(a - b, axis=2) / 2, 0, 1)))


def _directions(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    yaw, pitch = np.radians(angles[:, ::2]), np.radians(angles[:, 1::2])
    return np.stack(
        [np.sin(yaw) * np.cos(pitch), np.sin(pitch), np.cos(yaw) * np.cos(pitch)], axis=2
    )


def figures(scores: list[GazeScore]) -> dict[str, dict[str, float]]:
    """By kind of clip and method: medians over all frames and eyes of its clips."""
    rows = {}
    for kind in dict.fromkeys(score.kind for score in scores):
        for method in (OURS, FACE_MESH):
            own = [s for s in scores if s.kind == kind and s.method == method]
            if own:
                errors = np.concatenate([score.errors for score in own])
                remainders = np.concatenate([score.remainders for score in own])
                rows[f"{kind}: {method}"] = {
                    **{
                        key: float(
                            np.median([s.figures[key] for s in own if key in s.figures] or [np.nan])
                        )
                        for key in COLUMNS
                    },
                    "gaze": float(np.nanmedian(errors)),
                    "gaze_p90": float(np.nanquantile(errors, 0.9)),
                    "known": float(np.nanmedian(remainders)),
                }
    return rows


def clip_text(scores: list[GazeScore]) -> str:
    rows = {score.method: score.figures for score in scores}
    return text_table(scores[0].name, COLUMNS, rows)


def as_text(scores: list[GazeScore]) -> str:
    return text_table("medians", COLUMNS, figures(scores))


def as_json(scores: list[GazeScore]) -> str:
    clips = [{"name": s.name, "kind": s.kind, "method": s.method, **s.figures} for s in scores]
    return json_text({"kinds": figures(scores), "clips": clips})
