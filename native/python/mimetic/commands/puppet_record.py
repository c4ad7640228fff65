# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic puppet record`: a face recorded live, and sent to other programs while it plays."""

from __future__ import annotations

import argparse
import itertools
import time
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.commands.console import Console, say
from mimetic.commands.live_person import add_person_arguments, person_of
from mimetic.commands.live_source import open_source
from mimetic.commands.on_clip import add_lens_arguments, save_performance, tell_results
from mimetic.commands.send import add_send, addresses_of
from mimetic.performance.document import Performance
from mimetic.puppet.channels import CHANNELS, check_channels
from mimetic.puppet.clip_source import ClipSource
from mimetic.puppet.live_filter import DEFAULT_STILLNESS
from mimetic.puppet.recording import AUDIO, TAKE, Recording, RecordingOptions
from mimetic.puppet.taught_follower import SHARPEN, USES
from mimetic.puppet.templates import TaughtSet
from mimetic.puppet.warm_up import warm_up
from mimetic.shared.interrupts import Interrupt, listen_for_interrupt
from mimetic.shared.results import OF_A_CLIP, PERFORMANCE, prepare_folder, publish, staging

LONGEST = 24 * 3600.0  # seconds of a take


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "source", help="camera:0, camera:NAME or /dev/video0; or a video file, at its own speed"
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the take"
    )
    parser.add_argument(
        "--seconds",
        type=float,
        help="how long to record, from the first face on (default: until Ctrl-C, or the clip ends)",
    )
    parser.add_argument(
        "--countdown", type=int, default=0, metavar="N", help="seconds before a camera is recorded"
    )
    parser.add_argument(
        "--stillness",
        type=float,
        default=DEFAULT_STILLNESS,
        help="0 least lag to 1 least jitter (default: %(default)s); what it costs is printed",
    )
    parser.add_argument(
        "--set",
        type=Path,
        metavar="SET.npz",
        help="looks of this person that were taught (`mimetic puppet teach`)",
    )
    parser.add_argument(
        "--set-use",
        choices=USES,
        default=SHARPEN,
        help="sharpen: correct what the live filter measures, each by its variance (default); "
        "drive: take what the set knows from the set alone",
    )
    parser.add_argument(
        "--freeze",
        default="",
        metavar="CHANNEL,...",
        help=f"channels that stay as in the first picture: {', '.join(CHANNELS)}",
    )
    parser.add_argument(
        "--microphone", metavar="NAME", help="record its sound beside a camera (audio.wav)"
    )
    add_person_arguments(parser)
    add_lens_arguments(parser)
    add_send(parser)
    parser.add_argument(
        "--every-frame",
        action="store_true",
        help="of a clip: work on all frames, however long it takes, instead of at its speed",
    )


def run_record(arguments: argparse.Namespace) -> int:
    options = _options_of(arguments)
    source, inputs = open_source(arguments.source, arguments.every_frame)
    inputs += filter(None, (arguments.set, arguments.fit, arguments.person))
    if arguments.microphone and isinstance(source, ClipSource):
        raise InvalidInput("--microphone goes with a camera; a clip has its own sound")
    out = take_folder(arguments.out)
    prepare_folder(out, (*OF_A_CLIP, AUDIO, TAKE), *inputs)
    with staging(out) as folder, Console() as console, listen_for_interrupt() as interrupt:
        warm_up()
        recording = Recording(source, folder, options, console.tell)
        _tell_stillness(console, options.stillness, source.fps)
        _count_down(console, arguments.countdown, interrupt)
        try:
            performance = recording.run(interrupt)
        except UnreadableMedia:
            if interrupt():  # before there was anything to keep
                raise KeyboardInterrupt from None
            raise
        console.tell(recording.session.figures.line())
        return _publish(console, folder, out, performance)


def take_folder(out: Path) -> Path:
    """`out`, or in it a folder of its own where it has a performance: no take replaces another."""
    if not (out / PERFORMANCE).exists():
        return out
    numbers = (number for number in itertools.count(2) if not (out / f"take-{number}").exists())
    return out / f"take-{next(numbers)}"


def _publish(console: Console, folder: Path, out: Path, performance: Performance) -> int:
    save_performance(performance, folder / PERFORMANCE, console.tell)
    names = sorted(path.name for path in folder.iterdir())
    tell_results(console, performance, publish(folder, out, is_finished=True), names)
    return 0  # Ctrl-C is the usual way to end a take


def _options_of(arguments: argparse.Namespace) -> RecordingOptions:
    seconds = arguments.seconds
    if seconds is not None and not 0 < seconds <= LONGEST:
        raise InvalidInput(f"--seconds is {seconds:g}; it must be above 0, up to {LONGEST:g}")
    if not 0 <= arguments.countdown <= 60:
        raise InvalidInput(f"--countdown is {arguments.countdown}; it must be 0 to 60")
    if not 0 <= arguments.stillness <= 1:
        raise InvalidInput(f"--stillness is {arguments.stillness:g}; it must be 0 to 1")
    receivers = addresses_of(arguments)
    frozen = frozenset(filter(None, arguments.freeze.split(",")))
    check_channels(frozen)
    person, lens = person_of(arguments)
    return RecordingOptions(
        stillness=arguments.stillness,
        seconds=seconds,
        frozen=frozen,
        microphone=arguments.microphone,
        receivers=receivers,
        in_background=not arguments.every_frame,
        taught=TaughtSet.load(arguments.set) if arguments.set else None,
        use=arguments.set_use,
        lens=lens,
        person=person,
    )


def _tell_stillness(console: Console, stillness: float, fps: float) -> None:
    figures = _core.stillness_figures(stillness, fps)
    console.tell(
        f"stillness {stillness:g}: lags {figures.lag_frames:.1f} frames behind a quick motion, "
        f"keeps {100 * figures.jitter_share:.0f} % of the jitter"
    )


def _count_down(console: Console, seconds: int, interrupt: Interrupt) -> None:
    for left in range(seconds, 0, -1):
        console.tell(f"{left} ...")
        for _ in range(10):
            if interrupt():
                raise KeyboardInterrupt
            time.sleep(0.1)
    if seconds:
        say("\a", end="")
