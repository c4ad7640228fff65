# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic capture`: footage in; performance, overlay and report out."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from pathlib import Path

from mimetic.commands.footage_argument import give_rate
from mimetic.commands.on_clip import add_clip_arguments, run_on_clip
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.performance.corrections import load_corrections
from mimetic.performance.document import Performance
from mimetic.report.html import write_report
from mimetic.report.overlay import write_overlay
from mimetic.report.plots import plots_of
from mimetic.shared.parallel import both
from mimetic.shared.progress import ATTACHED, Costs, Progress
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import capture, check_range
from mimetic.solve.refining import check_of_capture

COSTS = Costs(followed_once=ATTACHED, followed_each=1.0, drawn_each=0.5, written=25.0)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_clip_arguments(parser, "face")
    parser.add_argument(
        "--corrections",
        type=Path,
        metavar="FILE.json",
        help="what a person says of single frames (docs/guide/corrections.md), as measurements",
    )


def run_capture(arguments: argparse.Namespace) -> int:
    give_rate(arguments)
    corrections = load_corrections(arguments.corrections) if arguments.corrections else ()
    if corrections:
        check_of_capture(corrections, check_range(arguments.frames, Footage(arguments.footage)))

    def follow(fit: FaceFit | None, progress: Progress, summary: CaptureSummary) -> Performance:
        return capture(arguments.footage, arguments.frames, fit, progress, summary, corrections)

    return run_on_clip(arguments, COSTS, follow, write_pictures)


def write_pictures(
    performance: Performance,
    footage: Footage,
    folder: Path,
    summary: CaptureSummary,
    progress: Progress | None = None,
    is_interrupted: Callable[[], bool] = lambda: False,
) -> None:
    """overlay.mp4 and report.html, after an interrupt the report alone."""

    def draw_overlay() -> None:
        start = time.perf_counter()
        if not is_interrupted():
            write_overlay(performance, footage, folder / "overlay.mp4", progress)
        summary.add("draw and encode the overlay", time.perf_counter() - start)

    _, plots = both(draw_overlay, lambda: plots_of(performance))
    write_report(performance, footage, folder / "report.html", summary, plots)
