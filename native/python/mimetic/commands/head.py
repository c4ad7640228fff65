# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic head`: footage in; head motion, overlay and plot out."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from mimetic import _core
from mimetic.commands.footage_argument import give_rate
from mimetic.commands.on_clip import add_clip_arguments, run_on_clip
from mimetic.fit.face_fit import FaceFit
from mimetic.head.smoothing import check_strength
from mimetic.head.tracking import MODELS, NUM_PASSES, PASS_COST, SMOOTHING, track_head
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.report.head_drawing import HeadDrawing, write_motion_plot
from mimetic.report.overlay import FaceDrawing, write_overlay
from mimetic.shared.progress import ATTACHED, Costs, Progress
from mimetic.solve.capture_summary import CaptureSummary

COSTS = Costs(
    followed_once=ATTACHED, followed_each=NUM_PASSES * PASS_COST, drawn_each=0.5, written=0.0
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_clip_arguments(parser, "head")
    parser.add_argument(
        "--model",
        choices=MODELS,
        default="ellipsoid",
        help="what stands for the head: the paper's ellipsoid (default), the planar patch that it "
        "compares with, or the person's fitted surface, for large turns",
    )
    parser.add_argument(
        "--fast",
        action="store_true",
        help="register samples of the skin, and ask the flow only where they leave doubt",
    )
    parser.add_argument(
        "--smoothing",
        type=float,
        default=SMOOTHING,
        metavar="STRENGTH",
        help="strength of the smoothing of the head's motion, which has no lag: what the standard "
        "deviations of poses are multiplied by (default: %(default)s; 0 leaves each frame as "
        "measured)",
    )


def run_head(arguments: argparse.Namespace) -> int:
    give_rate(arguments)
    model = arguments.model
    check_strength(arguments.smoothing)

    def follow(fit: FaceFit | None, progress: Progress, summary: CaptureSummary) -> Performance:
        return track_head(
            *(arguments.footage, model, arguments.frames, fit, progress, summary),
            fast=arguments.fast,
            smoothing=arguments.smoothing,
        )

    def draw(
        performance: Performance,
        footage: Footage,
        folder: Path,
        summary: CaptureSummary,
        progress: Progress,
        is_interrupted: Callable[[], bool],
    ) -> None:
        write_motion_plot(performance, folder / "motion.png")
        if not is_interrupted():
            assert summary.head_shape is not None  # tracking leaves it
            drawing = _drawing_of(performance, summary.head_shape)
            write_overlay(performance, footage, folder / "overlay.mp4", progress, drawing)

    return run_on_clip(arguments, COSTS, follow, draw)


def _drawing_of(performance: Performance, shape: _core.HeadShape) -> FaceDrawing | HeadDrawing:
    if shape.model == _core.HeadModel.surface:
        return FaceDrawing(performance)
    return HeadDrawing(performance, shape)
