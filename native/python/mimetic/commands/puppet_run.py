# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic puppet run`: a clip and a taught set in, a driven face out."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.footage_argument import give_rate
from mimetic.commands.on_clip import add_clip_arguments, run_on_clip
from mimetic.commands.puppet_teach import add_head
from mimetic.commands.send import add_send, addresses_of
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.driver import HEADS
from mimetic.puppet.mapping import BASES, MODES
from mimetic.puppet.pages import write_run
from mimetic.puppet.running import RunOptions, Trace, drive
from mimetic.puppet.templates import TaughtSet
from mimetic.shared.progress import ATTACHED, Costs, Progress
from mimetic.solve.capture_summary import CaptureSummary

COSTS = Costs(followed_once=ATTACHED, followed_each=0.5, drawn_each=1.5, written=30.0)
LONGEST_LAG = 1.0  # s


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_clip_arguments(parser, "face")
    parser.add_argument(
        "--templates", type=Path, required=True, metavar="SET.npz", help="a taught set"
    )
    parser.add_argument(
        "--mode",
        choices=MODES,
        default=RunOptions.mode,
        help="parts: brows, eyes and mouth each by their own templates (default); face: templates "
        "of the whole face, and nothing beyond the taught looks and what lies between them",
    )
    parser.add_argument(
        "--basis",
        choices=BASES,
        default=RunOptions.basis,
        help="of the interpolation: piecewise linear (default), or Gaussian",
    )
    parser.add_argument(
        "--lag",
        type=float,
        default=RunOptions.lag,
        metavar="SECONDS",
        help="of the filter on a face at rest; in motion it is less (default: %(default)s; "
        "0: none)",
    )
    parser.add_argument(
        "--neutral",
        type=int,
        metavar="FRAME",
        help="in which the face is at rest: calibrates the set for this day's light",
    )
    add_head(parser, HEADS)
    add_send(parser)


def run_run(arguments: argparse.Namespace) -> int:
    give_rate(arguments)
    taught = TaughtSet.load(arguments.templates)
    if not 0 <= arguments.lag <= LONGEST_LAG:
        raise InvalidInput(f"--lag {arguments.lag:g}: 0 to {LONGEST_LAG:g} seconds")
    options = RunOptions(
        *(arguments.mode, arguments.basis, arguments.head, arguments.lag, arguments.neutral),
        receivers=addresses_of(arguments),
    )
    traces: list[Trace] = []

    def follow(fit: FaceFit | None, progress: Progress, summary: CaptureSummary) -> Performance:
        performance, trace = drive(
            *(arguments.footage, taught, options, arguments.frames, fit, progress, summary)
        )
        traces.append(trace)
        return performance

    def draw(
        performance: Performance,
        footage: Footage,
        folder: Path,
        _summary: CaptureSummary,
        progress: Progress,
        is_interrupted: Callable[[], bool],
    ) -> None:
        write_run(
            *(taught, performance, traces[0], footage, options, folder),
            *(progress, is_interrupted),
        )

    return run_on_clip(arguments, COSTS, follow, draw)
