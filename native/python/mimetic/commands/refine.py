# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic refine`: a performance solved again around the frames that a person corrected."""

from __future__ import annotations

import argparse
import itertools
import os
import time
from collections.abc import Iterator
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.console import Console
from mimetic.commands.on_clip import parse_frames
from mimetic.media.footage import Footage
from mimetic.performance.corrections import load_corrections
from mimetic.performance.document import Performance
from mimetic.shared.counted import counted
from mimetic.shared.folder_lock import alone_with
from mimetic.shared.interrupts import listen_for_interrupt
from mimetic.shared.regular_file import check_target
from mimetic.solve.refined_spans import DIRECTIONS
from mimetic.solve.refining import refined

REPORT, OVERLAY = "report.html", "overlay.mp4"  # that a capture draws beside a performance
FAILED = 1  # exit status where another has the file's place


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument("footage", type=Path, help="the clip that it was captured from")
    parser.add_argument(
        "--corrections",
        type=Path,
        required=True,
        metavar="FILE.json",
        help="all corrections of the clip (docs/guide/corrections.md): those that an earlier "
        "refinement had and the file has not are taken back",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE.npz",
        help="where the refined performance goes (default: in place of the given one)",
    )
    parser.add_argument(
        "--range",
        type=parse_frames,
        metavar="A:B",
        help="frames that may change, all others stay as they are",
    )
    parser.add_argument(
        "--direction",
        choices=DIRECTIONS,
        default="both",
        help="forward: no frame before the first correction changes; backward: none after the last",
    )


def run_refine(arguments: argparse.Namespace) -> int:
    out = arguments.out or arguments.performance
    check_target(out, arguments.footage, arguments.corrections)
    corrections = load_corrections(arguments.corrections)
    state = _state(out)
    performance = Performance.load(arguments.performance)
    footage = Footage(arguments.footage)
    if not performance.is_of(footage.identity[1]):
        raise InvalidInput(
            f"{arguments.performance} was captured from {(performance.footage or ['?'])[0]}, "
            f"not from {footage.path.name}"
        )
    with Console() as console:
        with listen_for_interrupt("nothing is changed") as interrupt:

            def show(fraction: float, text: str) -> bool:
                console.show(fraction, text)
                return not interrupt()

            start = time.perf_counter()
            result = refined(performance, corrections, arguments.range, arguments.direction, show)
            seconds = time.perf_counter() - start
        if interrupt():
            return interrupt.status
        saved = _save(result, out, state)  # a signal ends it, and what was said stays true
        console.show(1.0, "done")
        console.tell(
            f"{saved}: {counted(len(corrections), 'frame')} corrected, solved in {seconds:.1f} s"
        )
        if saved == out and (names := _drawn_before(arguments.performance, out)):
            console.tell(
                f"{out.parent}: {names} still of the performance before; mimetic capture with "
                "--corrections draws anew"
            )
        if saved != out:
            console.tell(
                f"{out} was replaced while this was solved, and stays as it is: refine it again, "
                f"or put {saved.name} in its place"
            )
            return FAILED
    return 0


def _drawn_before(performance: Path, out: Path) -> str:
    """Which drawings of a capture lie beside a performance that is refined in place: they need
    the footage's pictures, and a refinement reads none."""
    if os.path.realpath(performance) != os.path.realpath(out):
        return ""
    names = [name for name in (REPORT, OVERLAY) if (out.parent / name).is_file()]
    return f"{' and '.join(names)} {'are' if len(names) > 1 else 'is'}" if names else ""


def _save(performance: Performance, out: Path, state: tuple[int, ...]) -> Path:
    """Saves at `out`, or beside what another has put there since; returns where. Raises OSError."""
    with alone_with(Path(os.path.realpath(out)).parent):  # others publish in the same folder
        if _state(out) not in ((), state):
            out = next(path for path in _beside(out) if not os.path.lexists(path))
        performance.save(out)
    return out


def _state(path: Path) -> tuple[int, ...]:
    """What another program that writes a file changes; () where there is none."""
    try:
        found = os.stat(path)
    except FileNotFoundError:
        return ()
    return found.st_mtime_ns, found.st_size, found.st_ino


def _beside(out: Path) -> Iterator[Path]:
    for number in itertools.count(1):
        ending = "refined" if number == 1 else f"refined-{number}"
        yield out.with_name(f"{out.stem}.{ending}{out.suffix}")
