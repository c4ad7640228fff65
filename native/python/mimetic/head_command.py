# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic head`: footage in; head motion, overlay and plot out."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.capture_command import INTERRUPTED, parse_frames, prepare_folder
from mimetic.console import Console, listen_for_interrupt
from mimetic.face_template import load_template
from mimetic.fit import FaceFit
from mimetic.footage import Footage
from mimetic.head_drawing import HeadDrawing, write_motion_plot
from mimetic.head_motion import MODELS, head_shape, track_head
from mimetic.overlay import FaceDrawing, write_overlay
from mimetic.pipeline import CaptureSummary, Progress
from mimetic.report import check_report_packages

TRACK_SHARE = 0.7  # of the whole command, for the progress bar


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("footage", type=Path, help="video of one head")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the results"
    )
    parser.add_argument(
        "--model",
        choices=MODELS,
        default="ellipsoid",
        help="what stands for the head: the paper's ellipsoid (default), the planar patch that it "
        "compares with, or the person's fitted surface, the most accurate",
    )
    parser.add_argument(
        "--frames",
        type=parse_frames,
        metavar="A:B",
        help="first and last frame, counted from 1; either may be left out",
    )
    parser.add_argument(
        "--fit", type=Path, metavar="FIT.json", help="a face fit, instead of finding one"
    )


def run_head(arguments: argparse.Namespace) -> int:
    check_report_packages()
    out = arguments.out
    footage = Footage(arguments.footage)
    fit = FaceFit.load(arguments.fit) if arguments.fit else None
    prepare_folder(out)
    with Console() as console, listen_for_interrupt() as interrupted:

        def advance(share: float, whole: float) -> Progress:
            def progress(fraction: float, text: str) -> bool:
                console.show(whole + share * fraction, text)
                return not interrupted()

            return progress

        summary = CaptureSummary()
        try:
            performance = track_head(
                *(arguments.footage, arguments.model, arguments.frames, fit),
                *(advance(TRACK_SHARE, 0.0), summary),
            )
        except (InvalidInput, UnreadableMedia):
            if interrupted():  # before there was anything to keep
                raise KeyboardInterrupt from None
            raise
        performance.save(out / "performance.npz")
        summary.fit.save(out / "fit.json")
        write_motion_plot(performance, out / "motion.png")
        written = ["performance.npz", "fit.json", "motion.png"]
        if arguments.model == "surface":
            drawing = FaceDrawing(performance)
        else:
            template = load_template()
            neutral = performance.neutral_vertices
            drawing = HeadDrawing(performance, head_shape(arguments.model, neutral, template))
        remaining = advance(1 - TRACK_SHARE, TRACK_SHARE)
        if not interrupted() and write_overlay(
            performance, footage, out / "overlay.mp4", remaining, drawing
        ):
            written.append("overlay.mp4")
        console.show(1.0, "done")
    for note in performance.notes or ():
        console.tell(f"note: {note}")
    console.tell(f"{out}: {', '.join(written)}; {performance.num_frames} frames")
    return INTERRUPTED if interrupted() else 0
