# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic refine`: a performance solved again around the frames that a person corrected."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.console import Console
from mimetic.commands.on_clip import parse_frames
from mimetic.media.footage import Footage
from mimetic.performance.corrections import load_corrections
from mimetic.performance.document import Performance
from mimetic.shared.interrupts import listen_for_interrupt
from mimetic.shared.regular_file import check_target
from mimetic.solve.refined_spans import DIRECTIONS
from mimetic.solve.refining import refined


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
    performance = Performance.load(arguments.performance)
    footage = Footage(arguments.footage)
    if not performance.is_of(footage.identity[1]):
        raise InvalidInput(
            f"{arguments.performance} was captured from {(performance.footage or ['?'])[0]}, "
            f"not from {footage.path.name}"
        )
    with Console() as console, listen_for_interrupt() as interrupt:

        def show(fraction: float, text: str) -> bool:
            console.show(fraction, text)
            return not interrupt()

        start = time.perf_counter()
        result = refined(performance, corrections, arguments.range, arguments.direction, show)
        seconds = time.perf_counter() - start
        if interrupt():
            console.tell(f"stopped: {out} is as it was")
            return interrupt.status
        result.save(out)
        console.show(1.0, "done")
        console.tell(f"{out}: {len(corrections)} frames corrected, solved in {seconds:.1f} s")
    return 0
