# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic capture`: footage in; performance, overlay and report out."""

from __future__ import annotations

import argparse
import re
import time
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.console import Console, listen_for_interrupt
from mimetic.fit import FaceFit
from mimetic.footage import Footage
from mimetic.overlay import write_overlay
from mimetic.performance import Performance
from mimetic.pipeline import CaptureSummary, Progress, capture
from mimetic.report import check_report_packages, write_report

INTERRUPTED = 130
CAPTURE_SHARE = 0.8  # of the whole command, for the progress bar
OVERLAY_SHARE = 0.95


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("footage", type=Path, help="video of one face")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the results"
    )
    parser.add_argument(
        "--frames",
        type=parse_frames,
        metavar="A:B",
        help="first and last frame, counted from 1; either may be left out. The file is decoded "
        "from its start, so that the numbers are exact",
    )
    parser.add_argument(
        "--fit", type=Path, metavar="FIT.json", help="a face fit, instead of finding one"
    )


def parse_frames(text: str) -> tuple[int | None, int | None]:
    """`A:B`, `A:`, `:B` as (first, last); raises argparse.ArgumentTypeError."""
    match = re.fullmatch(r"(\d{0,9}):(\d{0,9})", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is not A:B, such as 10:200")
    first, last = (int(number) if number else None for number in match.groups())
    if first == 0 or (last is not None and last < (first or 1)):
        raise argparse.ArgumentTypeError(
            f"{text!r}: frames count from 1, the first before the last"
        )
    return first, last


def run_capture(arguments: argparse.Namespace) -> int:
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
            performance = capture(
                *(arguments.footage, arguments.frames, fit, advance(CAPTURE_SHARE, 0.0), summary)
            )
        except (InvalidInput, UnreadableMedia):
            if interrupted():  # before there was anything to keep
                raise KeyboardInterrupt from None
            raise
        performance.save(out / "performance.npz")
        summary.fit.save(out / "fit.json")
        written = ["performance.npz", "fit.json"]
        remaining = advance(OVERLAY_SHARE - CAPTURE_SHARE, CAPTURE_SHARE)
        written += write_pictures(performance, footage, out, summary, remaining, interrupted)
        console.show(1.0, "done")
    for note in performance.notes or ():
        console.tell(f"note: {note}")
    console.tell(f"{out}: {', '.join(written)}; {performance.num_frames} frames")
    return INTERRUPTED if interrupted() else 0


def write_pictures(
    performance: Performance,
    footage: Footage,
    out: Path,
    summary: CaptureSummary,
    progress: Progress | None = None,
    interrupted=lambda: False,
) -> list[str]:
    """overlay.mp4 and report.html, after an interrupt the report alone; returns their names."""
    written = []
    start = time.perf_counter()
    if not interrupted() and write_overlay(performance, footage, out / "overlay.mp4", progress):
        written.append("overlay.mp4")
    summary.add("draw and encode the overlay", time.perf_counter() - start)
    write_report(performance, footage, out / "report.html", summary)
    return [*written, "report.html"]


def prepare_folder(folder: Path) -> None:
    """Makes sure, before hours of work, that results can be written; raises UnreadableMedia."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".mimetic-write-test"
        probe.touch()
        probe.unlink()
    except FileExistsError:
        raise InvalidInput(f"--out {folder} is a file; give a folder") from None
    except OSError as error:
        raise UnreadableMedia(
            f"--out {folder}: {error.strerror}; give a folder that can be written to"
        ) from None
