# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic puppet teach --camera`: looks are asked for, shown, and kept."""

from __future__ import annotations

import argparse
import sys
import threading
from pathlib import Path

from mimetic import InvalidInput
from mimetic.commands.console import Console, is_terminal, say
from mimetic.commands.live_source import open_source
from mimetic.commands.on_clip import add_lens_arguments, lens_of
from mimetic.commands.taught_set import page_of, save_set
from mimetic.puppet.live_filter import LiveFilter
from mimetic.puppet.live_session import LiveSession
from mimetic.puppet.live_teaching import LiveTeaching, LiveTeachingOptions
from mimetic.puppet.taught_look import named_looks, parse_shown_look
from mimetic.puppet.templates import TaughtSet
from mimetic.puppet.usual_looks import ASKED_FOR
from mimetic.puppet.warm_up import warm_up
from mimetic.shared.interrupts import listen_for_interrupt
from mimetic.shared.regular_file import check_target

MOST_LOOKS = 20
LONGEST_COUNTDOWN = 60  # seconds


def add_camera_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--countdown",
        type=int,
        metavar="N",
        help="with --camera: seconds before each look is kept (default: "
        f"{LiveTeachingOptions.countdown}); on a terminal Enter begins it",
    )
    parser.add_argument(
        "--again",
        type=Path,
        metavar="SET.npz",
        help="with --camera: a set of the same person that a camera taught; the looks named are "
        "taught again, or added, and its others stay",
    )
    parser.add_argument(
        "--every-frame",
        action="store_true",
        help="of a clip in a camera's place: work on all frames, however long it takes",
    )
    add_lens_arguments(parser, of="with --camera: ")


def check_for_clip(arguments: argparse.Namespace) -> None:
    """Raises InvalidInput for words that go with a camera, and for those that lack."""
    if arguments.footage is None:
        raise InvalidInput("give a video and its --performance, or --camera SOURCE")
    if arguments.performance is None:
        raise InvalidInput("--performance is missing: capture the video first, or teach --camera")
    for word in ("countdown", "again", "every_frame", "focal", "sensor"):
        if getattr(arguments, word) not in (None, False):
            raise InvalidInput(f"--{word.replace('_', '-')} goes with --camera")


def teach_from_camera(arguments: argparse.Namespace) -> int:
    for word in ("footage", "performance", "frames", "choose"):
        if getattr(arguments, word) is not None:
            name = word if word == "footage" else f"--{word}"
            raise InvalidInput(f"{name} does not go with --camera")
    options = _options_of(arguments)
    lens = lens_of(arguments)
    out: Path = arguments.out
    old = TaughtSet.load(arguments.again) if arguments.again else None
    if old is not None and not arguments.look:
        raise InvalidInput("--again: name the looks to teach again with --look")
    source, inputs = open_source(arguments.camera, arguments.every_frame)
    for target in (out, page_of(out)):
        check_target(target, *inputs)
    live = LiveFilter(stillness=0.0, in_background=not arguments.every_frame, lens=lens)
    looks = named_looks(
        map(parse_shown_look, arguments.look or ASKED_FOR), arguments.state, live.names
    )
    if len(looks) > MOST_LOOKS:
        raise InvalidInput(f"--look: at most {MOST_LOOKS} at a time")
    warm_up()
    tell = Console().tell
    key = _EnterKey() if sys.stdin is not None and sys.stdin.isatty() else None
    bell = _ring if is_terminal() else _keep_quiet
    teaching = LiveTeaching(live, looks, tell, options, old, key, bell)
    with listen_for_interrupt() as interrupt:
        session = LiveSession(source, live, teaching.see, tell)
        session.run(interrupt)
        try:
            taught = teaching.taught()
        except InvalidInput:
            if interrupt():  # before there was anything to keep
                raise KeyboardInterrupt from None
            raise
        status = save_set(taught, out)
    if teaching.left and not interrupt():
        raise InvalidInput(
            f"{source.name} ended before these looks were kept: {', '.join(teaching.left)}"
        )
    return interrupt.status or status


def _options_of(arguments: argparse.Namespace) -> LiveTeachingOptions:
    usual = LiveTeachingOptions()
    countdown = usual.countdown if arguments.countdown is None else arguments.countdown
    if not 0 <= countdown <= LONGEST_COUNTDOWN:
        raise InvalidInput(f"--countdown is {countdown}; it must be 0 to {LONGEST_COUNTDOWN}")
    return LiveTeachingOptions(countdown, arguments.examples, arguments.head)


class _EnterKey:
    """Whether Enter was pressed since the last call."""

    def __init__(self) -> None:
        self._pressed = threading.Event()
        threading.Thread(target=self._read, name="keys", daemon=True).start()

    def __call__(self) -> bool:
        is_pressed = self._pressed.is_set()
        self._pressed.clear()
        return is_pressed

    def _read(self) -> None:
        for _ in sys.stdin:
            self._pressed.set()


def _ring() -> None:
    say("\a", end="")


def _keep_quiet() -> None:
    pass
