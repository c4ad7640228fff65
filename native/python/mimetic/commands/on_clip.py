# SPDX-License-Identifier: GPL-3.0-or-later
"""What the commands that follow a clip share: arguments, progress, interrupts, files."""

from __future__ import annotations

import argparse
import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.console import Console
from mimetic.commands.footage_argument import add_footage_argument
from mimetic.fit.fitting import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.fit.person import with_person
from mimetic.media.footage import Footage
from mimetic.media.frame_range import parse_range
from mimetic.performance.document import Performance
from mimetic.report.html import check_report_packages
from mimetic.shared.counted import counted
from mimetic.shared.interrupts import listen_for_interrupt
from mimetic.shared.pinhole import FULL_FRAME_MM
from mimetic.shared.progress import SEARCHED, Costs, Progress, stages
from mimetic.shared.results import OF_A_CLIP, PERFORMANCE, prepare_folder, publish, staging
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import check_range, check_rest, find_face
from mimetic.solve.walk import before_range

Follow = Callable[[FaceFit | None, Progress, CaptureSummary], Performance]
# (performance, footage, folder, summary, progress, is_interrupted): writes pictures in the folder
Draw = Callable[[Performance, Footage, Path, CaptureSummary, Progress, Callable[[], bool]], None]


def add_clip_arguments(parser: argparse.ArgumentParser, subject: str) -> None:
    add_footage_argument(parser, f"one {subject}")
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
        "--person",
        type=Path,
        metavar="FIT.json",
        help="a fit of the same person in other footage: its head shape and calibration are kept, "
        "where the head is gets found here",
    )
    parser.add_argument(
        "--face",
        type=parse_place,
        metavar="X,Y",
        help="of several faces, the one nearest to this pixel (default: the largest)",
    )
    add_rest_argument(parser)
    add_lens_arguments(parser)


def add_rest_argument(parser: argparse.ArgumentParser, *older_names: str) -> None:
    parser.add_argument(
        "--rest",
        *older_names,
        type=int,
        metavar="FRAME",
        help="the frame, counted from 1, in which the face is at rest: the head is fitted to it "
        "(default: one is chosen, and the command says which and why)",
    )


def add_lens_arguments(parser: argparse.ArgumentParser, of: str = "") -> None:
    """of: what the help begins with, such as the argument that these go with."""
    parser.add_argument(
        "--focal",
        type=float,
        metavar="MM",
        help=f"{of}focal length that the clip was filmed with, if it is known (default: 1.2 widths "
        "of the picture)",
    )
    parser.add_argument(
        "--sensor",
        type=float,
        metavar="MM",
        help=f"{of}length of the camera's sensor along the picture's width, of --focal (default: "
        f"{FULL_FRAME_MM:g}, full frame; upright pictures of a phone whose lens is stated for full "
        "frame: 20.25)",
    )


def lens_of(arguments: argparse.Namespace) -> KnownLens | None:
    """Of a face to find; raises InvalidInput."""
    focal_mm, sensor_mm = arguments.focal, arguments.sensor
    if focal_mm is None and sensor_mm is not None:
        raise InvalidInput(f"--sensor {sensor_mm:g} is of a focal length: give --focal MM too")
    if focal_mm is None:
        return None
    if getattr(arguments, "fit", None):
        raise InvalidInput(
            "--focal is of a face to find, and --fit has the lens that it was found with: give one "
            "of them"
        )
    return KnownLens(focal_mm, FULL_FRAME_MM if sensor_mm is None else sensor_mm)


def parse_frames(text: str) -> tuple[int | None, int | None]:
    """`A:B`, `A:`, `:B` as (first, last); raises argparse.ArgumentTypeError."""
    try:
        return parse_range(text)
    except InvalidInput as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def parse_place(text: str) -> tuple[float, float]:
    """`X,Y` in pixels; raises argparse.ArgumentTypeError."""
    match = re.fullmatch(r"(\d{1,5}(?:\.\d{1,9})?),(\d{1,5}(?:\.\d{1,9})?)", text)
    if not match:
        raise argparse.ArgumentTypeError(f"{text!r} is not X,Y in pixels, such as 320,180")
    return float(match[1]), float(match[2])


def run_on_clip(arguments: argparse.Namespace, costs: Costs, follow: Follow, draw: Draw) -> int:
    """Follows the clip, saves, draws and reports; returns the exit status.

    costs: of following, with a fit, and of what comes after, for the time left. The results
    appear in the folder together when all are done; of a run that is stopped, or fails after the
    following, what is finished is kept. Raises what the work raises.
    """
    check_report_packages()
    out, footage = arguments.out, Footage(arguments.footage)
    fit, person = _given_fits(arguments)
    lens = lens_of(arguments)
    is_found_first = bool(arguments.face or person or lens or arguments.rest is not None)
    first, last = check_range(arguments.frames, footage)
    check_rest(arguments.rest, footage)
    prepare_folder(out, OF_A_CLIP, footage.path, *filter(None, [arguments.person]))
    summary = CaptureSummary()
    with staging(out) as folder, Console() as console, listen_for_interrupt() as interrupt:

        def show(fraction: float, text: str) -> bool:
            console.show(fraction, text)
            return not interrupt()

        num_frames = 1 + last - first
        console.tell(beginning(footage, (first, last), fit))
        search_cost = 0.0 if fit else SEARCHED
        following_cost = costs.followed_once + num_frames * costs.followed_each
        finding, following, drawing, _ = stages(
            show,
            search_cost if is_found_first else 0.0,
            following_cost if is_found_first else search_cost + following_cost,
            num_frames * costs.drawn_each,
            costs.written,
        )
        try:
            if is_found_first:
                fit = _found(arguments, person, lens, finding)
            performance = follow(fit, following, summary)
        except (InvalidInput, UnreadableMedia):
            if interrupt():  # before there was anything to keep
                raise KeyboardInterrupt from None
            raise
        save_performance(performance, folder / PERFORMANCE, console.tell)
        failure = summary.footage.failure if summary.footage else None
        assert summary.fit is not None  # given, or found before anything was followed
        try:
            summary.fit.save(folder / "fit.json")
            draw(performance, footage, folder, summary, drawing, interrupt)
            failure = failure or footage.failure  # of the pictures, not all of which are drawn
        except OSError as error:  # a full disk, footage that is gone: the capture is done
            failure = failure or error
        console.show(1.0, "done")
        names = sorted(path.name for path in folder.iterdir())
        where = publish(folder, out, is_finished=not interrupt() and failure is None)
        console.tell(summary.fit.rest_text())
        tell_results(console, performance, where, names)
        if where != out:
            console.tell(f"note: not finished; {out} keeps the results that were there before")
        if failure:
            raise failure
    return interrupt.status


def _found(
    arguments: argparse.Namespace,
    person: FaceFit | None,
    lens: KnownLens | None,
    progress: Progress,
) -> FaceFit:
    rest, frames, near = arguments.rest, arguments.frames, arguments.face
    fit = find_face(arguments.footage, rest, frames, progress, near, lens)
    return with_person(fit, person) if person else fit


def beginning(footage: Footage, frames: tuple[int, int], fit: FaceFit | None) -> str:
    """What a run will do, before it does it; how long is told once some of it is done."""
    first, last = frames
    num_frames = 1 + last - first
    seconds = num_frames / float(footage.fps)
    followed = f"following it through {counted(num_frames, 'frame')}"
    searching = "" if fit else "finding the face, "
    if fit and (way := before_range(fit, frames)):
        searching = f"following the face through {way}, then "
    return (
        f"{footage.path.name}: {searching}{followed} from {first} on "
        f"({seconds:.1f} s), drawing it over them; Ctrl-C keeps the part that is finished"
    )


def _given_fits(arguments: argparse.Namespace) -> tuple[FaceFit | None, FaceFit | None]:
    """A fit of this footage, and one of the person in other footage."""
    if arguments.fit and (arguments.face or arguments.person or arguments.rest is not None):
        raise InvalidInput(
            "--face, --person and --rest are of a face to find, --fit says where it is: give one "
            "of them"
        )
    fit, person = (
        FaceFit.load(path) if path else None for path in (arguments.fit, arguments.person)
    )
    return fit, person


def save_performance(performance: Performance, path: Path, tell: Callable[[str], None]) -> None:
    """Saves hours of work: where `path` cannot be written, in the system's folder for such files.

    Raises the OSError of the first try.
    """
    try:
        performance.save(path)
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="mimetic-"))
        try:
            performance.save(folder / path.name)
        except OSError:
            shutil.rmtree(folder, ignore_errors=True)
        else:
            tell(f"{folder / path.name}: kept here, {counted(performance.num_frames, 'frame')}")
        raise


def tell_results(
    console: Console, performance: Performance, folder: Path, names: list[str]
) -> None:
    for note in performance.notes or ():
        console.tell(f"note: {note}")
    console.tell(f"{folder}: {', '.join(names)}; {counted(performance.num_frames, 'frame')}")
