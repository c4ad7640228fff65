# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic puppet teach`: looks of a clip or a camera in, a taught set and its page out."""

from __future__ import annotations

import argparse
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.console import Console
from mimetic.commands.on_clip import parse_frames
from mimetic.commands.puppet_teach_camera import (
    add_camera_arguments,
    check_for_clip,
    teach_from_camera,
)
from mimetic.commands.taught_set import page_of, save_set
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.puppet.driver import HEADS
from mimetic.puppet.seeing import MODEL
from mimetic.puppet.taught_look import named_looks, parse_look
from mimetic.puppet.teaching import MOST_EXAMPLES, has_own_state, teach
from mimetic.report.html import check_report_packages
from mimetic.shared.regular_file import check_input, check_target
from mimetic.solve.clip_capture import check_range

USUAL_CHOSEN = 9  # looks, where none is named
MOST_CHOSEN = 40


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("footage", type=Path, nargs="?", help="video of one face")
    parser.add_argument("--performance", type=Path, help="performance.npz of its capture")
    parser.add_argument(
        "--camera",
        metavar="SOURCE",
        help="instead of footage: show the looks to a camera, one after the other (camera:0, "
        "camera:NAME, /dev/video0, or a video file at its own speed in its place)",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="SET.npz", help="file to write")
    parser.add_argument(
        "--look",
        action="append",
        default=[],
        metavar="NAME=FRAME[:PART,PART]",
        help="how the face looks in a frame (with --camera: NAME[:PART,PART], in the order in "
        "which they are asked for); of these parts alone: face, brows, eyes, brow.L, "
        "brow.R, eye.L, eye.R, mouth (default: all that differ from the other looks). The look "
        "called neutral is the face at rest. May be given again",
    )
    parser.add_argument(
        "--state",
        action="append",
        default=[],
        metavar="NAME=STATE",
        help="what a look drives, instead of what was captured in its frame or seen live: a file "
        "of `mimetic library`, a frame of a capture (performance.npz:120), or sliders, such as "
        "MUSCLE:0.8,jaw_open:0.2",
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
        "%(default)s; 0: the looks alone, as where a look has a --state)",
    )
    parser.add_argument(
        "--frames", type=parse_frames, metavar="A:B", help="teach from these frames alone"
    )
    add_head(parser, HEADS[:2])
    add_camera_arguments(parser)


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
    return teach_from_camera(arguments) if arguments.camera else _teach_from_clip(arguments)


def _teach_from_clip(arguments: argparse.Namespace) -> int:
    check_for_clip(arguments)
    out: Path = arguments.out
    check_input(arguments.performance, "a performance (the performance.npz of a capture)")
    for target in (out, page_of(out)):
        check_target(target, arguments.footage, arguments.performance)
    footage = Footage(arguments.footage)
    performance = Performance.load(arguments.performance)
    if not performance.is_of(fingerprint(footage.path)):
        raise InvalidInput(
            f"{arguments.performance} was captured from other footage than {footage.path.name}"
        )
    channels = {*performance.muscles, *performance.articulators}
    looks = named_looks(map(parse_look, arguments.look), arguments.state, channels)
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
        if arguments.examples and has_own_state(looks):
            console.tell("no examples are kept: they would contradict the looks with a --state")
    return save_set(taught, out)
