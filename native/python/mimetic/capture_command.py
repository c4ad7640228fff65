# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic capture`: footage in; performance, overlay and report out."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

from mimetic.clip_command import add_clip_arguments, run_on_clip
from mimetic.footage import Footage
from mimetic.overlay import write_overlay
from mimetic.paper_loop import capture_by_loop
from mimetic.performance import Performance
from mimetic.pipeline import CaptureSummary, capture
from mimetic.progress import ATTACHED, Costs, Progress
from mimetic.report import write_report

COSTS = Costs(followed_once=ATTACHED, followed_each=1.0, drawn_each=0.5, written=60.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_clip_arguments(parser, "face")
    parser.add_argument(
        "--estimator",
        choices=("anchored", "loop"),
        default="anchored",
        help="anchored: each frame against reference textures; loop: the paper's own, from frame "
        "to frame, to compare with (default: anchored)",
    )


def run_capture(arguments: argparse.Namespace) -> int:
    follow_face = capture if arguments.estimator == "anchored" else capture_by_loop

    def follow(fit, progress, summary):
        summary.settings["estimator"] = arguments.estimator
        return follow_face(arguments.footage, arguments.frames, fit, progress, summary)

    return run_on_clip(arguments, COSTS, follow, write_pictures)


def write_pictures(
    performance: Performance,
    footage: Footage,
    folder: Path,
    summary: CaptureSummary,
    progress: Progress | None = None,
    interrupted: Callable[[], bool] = lambda: False,
) -> None:
    """overlay.mp4 and report.html, after an interrupt the report alone."""
    start = time.perf_counter()
    if not interrupted():
        write_overlay(performance, footage, folder / "overlay.mp4", progress)
    summary.add("draw and encode the overlay", time.perf_counter() - start)
    write_report(performance, footage, folder / "report.html", summary)
