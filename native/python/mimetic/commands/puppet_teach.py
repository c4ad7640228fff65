# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic puppet teach`: looks of a captured clip in, a taught set and its page out."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.console import Console
from mimetic.commands.on_clip import parse_frames
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.driver import HEADS
from mimetic.puppet.pages import write_taught_page
from mimetic.puppet.seeing import MODEL
from mimetic.puppet.taught_look import Look, parse_look, parse_state
from mimetic.puppet.teaching import MOST_EXAMPLES, teach
from mimetic.report.html import check_report_packages
from mimetic.shared.regular_file import check_input, check_target
from mimetic.shared.shown_text import shown
from mimetic.solve.clip_capture import check_range

USUAL_CHOSEN = 9  # looks, where none is named
MOST_CHOSEN = 40
MOST_ADVICE = 3  # lines that are printed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("footage", type=Path, help="video of one face")
    parser.add_argument(
        "--performance", type=Path, required=True, help="performance.npz of its capture"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="SET.npz", help="file to write")
    parser.add_argument(
        "--look",
        action="append",
        default=[],
        metavar="NAME=FRAME[:PART,PART]",
        help="how the face looks in a frame; of these parts alone: face, brows, eyes, brow.L, "
        "brow.R, eye.L, eye.R, mouth (default: all that differ from the other looks). The look "
        "called neutral is the face at rest. May be given again",
    )
    parser.add_argument(
        "--state",
        action="append",
        default=[],
        metavar="NAME=STATE",
        help="what a look drives, instead of what was captured in its frame: a file of `mimetic "
        "library`, or sliders, such as MUSCLE:0.8,jaw_open:0.2",
    )
    parser.add_argument(
        "--choose",
        type=int,
        metavar="N",
        help="up to so many more looks, the frames that differ most (default: "
        f"{USUAL_CHOSEN} where no --look is given, otherwise none)",
    )
    parser.add_argument(
        "--examples",
        type=int,
        default=MOST_EXAMPLES,
        metavar="N",
        help="captured frames that are kept beside the looks to interpolate between (default: "
        "%(default)s; 0: the looks alone)",
    )
    parser.add_argument(
        "--frames", type=parse_frames, metavar="A:B", help="teach from these frames alone"
    )
    add_head(parser, HEADS[:2])


def add_head(parser: argparse.ArgumentParser, heads: tuple[str, ...]) -> None:
    """What holds the face still, of driver.HEADS."""
    text = "what holds the face still: the head's motion, by the person's surface (default) or the "
    text += "paper's ellipsoid"
    parser.add_argument(
        "--head",
        choices=heads,
        default=MODEL,
        help=text + ("; free: the templates alone, as in the paper" if "free" in heads else ""),
    )


def run_teach(arguments: argparse.Namespace) -> int:
    check_report_packages()
    out: Path = arguments.out
    if out.suffix != ".npz":
        raise InvalidInput(f"--out {out.name}: a taught set is an .npz file")
    if not 0 <= (arguments.choose or 0) <= MOST_CHOSEN or not 0 <= arguments.examples <= 500:
        raise InvalidInput(f"--choose is 0 to {MOST_CHOSEN}, --examples 0 to 500")
    check_input(arguments.performance, "a performance (the performance.npz of a capture)")
    page = out.with_suffix(".html")
    for target in (out, page):
        check_target(target, arguments.footage, arguments.performance)
    footage = Footage(arguments.footage)
    performance = Performance.load(arguments.performance)
    if not performance.is_of(fingerprint(footage.path)):
        raise InvalidInput(
            f"{arguments.performance} was captured from other footage than {footage.path.name}"
        )
    looks = _looks(arguments, performance)
    num_chosen = arguments.choose
    if num_chosen is None:
        num_chosen = 0 if looks else USUAL_CHOSEN
    frames = check_range(arguments.frames, footage) if arguments.frames else None
    with Console() as console:

        def show(fraction: float, text: str) -> bool:
            console.show(fraction, text)
            return True

        taught = teach(
            *(footage, performance, looks, num_chosen, frames, arguments.examples, show),
            model=arguments.head,
        )
        taught.save(out)
        lines = write_taught_page(taught, page, out.stem)
    print(
        f"{shown(out)}: {len(taught.looks)} looks, {len(taught.template_parts)} templates, "
        f"{len(taught.example_scores)} examples"
    )
    for line in lines[:MOST_ADVICE]:
        print(f"advice: {shown(line)}")
    print(f"{shown(page)}: the templates, and all advice ({len(lines)} lines)")
    return 0


def _looks(arguments: argparse.Namespace, performance: Performance) -> list[Look]:
    looks = {look.name: look for look in map(parse_look, arguments.look)}
    if len(looks) != len(arguments.look):
        raise InvalidInput("--look: two looks have one name")
    for text in arguments.state:
        name, values = parse_state(text, performance)
        if name not in looks:
            raise InvalidInput(f"--state {name}: there is no --look of that name")
        looks[name] = dataclasses.replace(looks[name], values=values)
    return list(looks.values())
