# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic evaluate locate`: finders of faces side by side on still images."""

from __future__ import annotations

from pathlib import Path
from typing import BinaryIO

from mimetic import InvalidInput, _core
from mimetic.score.json_text import json_text
from mimetic.score.text_table import text_table
from mimetic.shared.installed_data import data_folder
from mimetic.shared.whole_file import whole_file

from evaluation.runs.finders import CASCADES, run_cascade, run_eigenspaces, run_locator
from evaluation.runs.locate_score import FALSE_PER_IMAGE, LocateScore, score_run
from evaluation.runs.stills import Stills

RATES = {
    "found": (f"found at {FALSE_PER_IMAGE}", ".3f"),
    "found_frontal": ("below 15 deg", ".3f"),
    "found_turned": ("15 to 30 deg", ".3f"),
    "found_at_all": ("found at all", ".3f"),
    "false_at_all": ("false / image", ".3f"),
    "ms": ("ms / image", ".1f"),
}
ERRORS = {
    f"{part}_{suffix}": (f"{part} {label}", ".1f")
    for part in ("eye", "nose", "mouth")
    for suffix, label in (("median", "median"), ("p90", "90 %"))
}


def score_finders(stills: Stills, spaces: _core.FaceSpaces) -> dict[str, LocateScore]:
    """Mimetic's finder, its two halves and OpenCV's cascades on the same images.

    Raises InvalidInput for images without a face and for spaces without a module of each part.
    """
    if not stills.has_face.any():
        raise InvalidInput("none of the images shows a face: there is nothing to find")
    runs = {
        "mimetic": run_locator(stills, spaces),
        "eigenspaces": run_eigenspaces(spaces, stills),
        "cascades, measured": run_locator(stills, None),
    }
    for name, file in CASCADES.items():
        if (data_folder() / file).exists():  # systems need not bring every cascade
            runs[name] = run_cascade(file, stills)
    return {name: score_run(run, stills) for name, run in runs.items()}


def as_text(scores: dict[str, LocateScore]) -> str:
    first = next(iter(scores.values()))
    rows = {name: score.figures for name, score in scores.items()}
    return "\n\n".join(
        [
            f"{first.images} images, {first.faces} of them of a face",
            text_table(f"rates at {FALSE_PER_IMAGE} false alarms an image", RATES, rows),
            text_table("errors, % of interpupillary distance", ERRORS, rows),
        ]
    )


def as_json(scores: dict[str, LocateScore]) -> str:
    """Figures and curves by finder; what is undefined is null."""
    document = {}
    for name, score in scores.items():
        curve = ("threshold", "false_per_image", "found_rate")
        document[name] = score.figures | {key: getattr(score, key).tolist() for key in curve}
    return json_text(document)


def write(scores: dict[str, LocateScore], folder: Path) -> None:
    """locate.json and locate_roc.png, each whole or not at all; raises OSError."""
    folder.mkdir(parents=True, exist_ok=True)
    with whole_file(folder / "locate.json") as stream:
        stream.write(f"{as_json(scores)}\n".encode())
    with whole_file(folder / "locate_roc.png") as stream:
        _plot(scores, stream)


def _plot(scores: dict[str, LocateScore], stream: BinaryIO) -> None:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 4.2), layout="constrained")
    axes = figure.subplots()
    for name, score in scores.items():
        ends = ([0, *score.false_per_image], [0, *score.found_rate])
        axes.step(*ends, where="post", marker=".", markersize=4, label=name)
    axes.axvline(FALSE_PER_IMAGE, color="0.7", linewidth=0.8)
    axes.set_xlabel("false alarms per image")
    axes.set_ylabel("faces found")
    axes.set_ylim(0, 1.02)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower right")
    axes.set_title(f"{score.faces} faces in {score.images} images", fontsize=10)
    figure.savefig(stream, format="png", dpi=130)
