# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic calibrate`: a few seconds of a person in; a fit that knows skin and muscles out."""

from __future__ import annotations

import argparse
import math
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.commands.console import Console
from mimetic.commands.footage_argument import add_footage_argument, give_rate
from mimetic.commands.on_clip import add_lens_arguments, lens_of, parse_frames
from mimetic.fit.fitting import FaceFit
from mimetic.muscles.calibration import REGIONS
from mimetic.shared.interrupts import listen_for_interrupt
from mimetic.shared.regular_file import check_target
from mimetic.solve.calibrate import MOST_ROUNDS, CalibrationResult
from mimetic.solve.calibration_run import LEAST_FRAMES, MOST_FRAMES, calibrate


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Find by evidence how firmly this person's skin is held, by region, and how strong the "
        "muscles are, from a few seconds that show expressions. The result is kept in the fit, and "
        "every capture with it (mimetic capture --fit) uses it."
    )
    add_footage_argument(parser, "one face, showing expressions")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="FIT.json", help="the calibrated fit"
    )
    parser.add_argument(
        "--fit", type=Path, metavar="FIT.json", help="a fit of this footage, instead of finding one"
    )
    parser.add_argument(
        "--frames",
        type=parse_frames,
        metavar="A:B",
        help="first and last frame to rest on, counted from 1 (default: the whole clip, which "
        f"must have {LEAST_FRAMES} to {MOST_FRAMES} frames; otherwise give A:B)",
    )
    add_lens_arguments(parser)


def run_calibrate(arguments: argparse.Namespace) -> int:
    """Writes the fit and prints the factors; bad input raises, and writes nothing."""
    give_rate(arguments)
    out = arguments.out
    check_target(out, arguments.footage)
    lens = lens_of(arguments)
    fit = FaceFit.load(arguments.fit) if arguments.fit else None
    with Console() as console, listen_for_interrupt("nothing is kept") as interrupt:

        def progress(fraction: float, text: str) -> bool:
            console.show(fraction, text)
            return not interrupt()

        try:
            fit, result = calibrate(arguments.footage, arguments.frames, fit, progress, lens)
        except (InvalidInput, UnreadableMedia):
            if interrupt():
                raise KeyboardInterrupt from None
            raise
        console.show(1.0, "done")
    fit.save(out)
    print(described(result))
    print(f"{out}: calibrated to {len(result.calibration.frames)} frames that differ most")
    return 0


def described(result: CalibrationResult) -> str:
    """The result as text: a line for each factor with its range of one standard deviation."""
    calibration = result.calibration
    lines = ["attachment of the skin to the bone, times what is assumed"]
    lines += [
        _line(name, calibration.stiffness.get(name), result.stiffness_std[name]) for name in REGIONS
    ]
    if calibration.insertion:
        lines.append("insertions, millimetres away from the midline and up from where assumed")
        lines += [
            f"  {name:34} {_shifts(place, result.insertion_std[name])}"
            for name, place in calibration.insertion.items()
        ]
    if calibration.strength:
        lines.append("strength of the muscles that were seen at work, times what is assumed")
        lines += [
            _line(name, calibration.strength[name], result.strength_std[name])
            for name in calibration.strength
        ]
    if not result.is_settled:
        lines.append(f"still moving after {MOST_ROUNDS} rounds: the ranges are too narrow")
    lines.append(f"logarithm of the evidence: {result.gain:+.1f} against all factors at 1")
    return "\n".join(lines)


def _line(name: str, factor: float | None, std: float) -> str:
    if factor is None:
        return f"  {name:34} 1     not seen well enough"
    low, high = (factor * math.exp(sign * std) for sign in (-1, 1))
    return f"  {name:34} {factor:.2f}  {low:.2f} to {high:.2f}"


def _shifts(place: tuple[float, float], stds: tuple[float, float]) -> str:
    """Away from the midline, and up; 0 to the last digit is what the footage does not inform."""
    words = [
        f"{mm:+.1f}  {mm - std:+.1f} to {mm + std:+.1f}" if mm else "0  not seen well enough"
        for mm, std in zip(place, stds, strict=True)
    ]
    return "".join(f"{one:26}" for one in words).rstrip()
