# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands that follow a clip share: arguments, progress, interrupts, files."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.console import Console, listen_for_interrupt
from mimetic.fit import FaceFit
from mimetic.footage import Footage
from mimetic.performance import Performance
from mimetic.pipeline import CaptureSummary, Progress, find_face
from mimetic.report import check_report_packages

INTERRUPTED = 130
Follow = Callable[[FaceFit | None, Progress, CaptureSummary], Performance]
# (performance, footage, summary, progress, interrupted) -> names of the files written
Draw = Callable[[Performance, Footage, CaptureSummary, Progress, Callable[[], bool]], list[str]]


def add_clip_arguments(parser: argparse.ArgumentParser, shown: str) -> None:
    parser.add_argument("footage", type=Path, help=f"video of one {shown}")
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
    parser.add_argument(
        "--face",
        type=parse_place,
        metavar="X,Y",
        help="of several faces, the one nearest to this pixel (default: the largest)",
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


def parse_place(text: str) -> tuple[float, float]:
    """`X,Y` in pixels; raises argparse.ArgumentTypeError."""
    match = re.fullmatch(r"(\d{1,5}(?:\.\d{1,9})?),(\d{1,5}(?:\.\d{1,9})?)", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y in pixels, such as 320,180")
    return float(match[1]), float(match[2])


def run_on_clip(
    arguments: argparse.Namespace, shares: tuple[float, float], follow: Follow, draw: Draw
) -> int:
    """Follows, saves, draws, tells; returns the exit status.

    shares: of the whole command done when following and when drawing with progress ends.
    """
    check_report_packages()
    out = arguments.out
    footage = Footage(arguments.footage)
    if arguments.fit and arguments.face:
        raise InvalidInput(
            "--face chooses a face to find, --fit says where it is: give one of them"
        )
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
            if arguments.face:
                frames, near = arguments.frames, arguments.face
                fit = find_face(footage.path, frames=frames, near=near)
            performance = follow(fit, advance(shares[0], 0.0), summary)
        except (InvalidInput, UnreadableMedia):
            if interrupted():  # before there was anything to keep
                raise KeyboardInterrupt from None
            raise
        performance.save(out / "performance.npz")
        summary.fit.save(out / "fit.json")
        remaining = advance(shares[1] - shares[0], shares[0])
        drawn = draw(performance, footage, summary, remaining, interrupted)
        written = ["performance.npz", "fit.json", *drawn]
        console.show(1.0, "done")
    for note in performance.notes or ():
        console.tell(f"note: {note}")
    console.tell(f"{out}: {', '.join(written)}; {performance.num_frames} frames")
    return INTERRUPTED if interrupted() else 0


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
