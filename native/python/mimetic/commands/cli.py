# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line: `mimetic COMMAND ...`.

Exit status: 0 done, 1 failed, 2 bad input, 129 ended by SIGHUP (the terminal was closed), 130 by
Ctrl-C, 143 by SIGTERM.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Callable, Sequence
from typing import TextIO

from mimetic import InvalidInput, UnreadableMedia, __version__
from mimetic.commands.console import say
from mimetic.shared.interrupts import signals_raised
from mimetic.shared.shown_text import shown

# command: (module with add_arguments(parser) and run_<command>(arguments) -> status, summary)
COMMANDS = {
    "capture": (
        "mimetic.commands.capture",
        "video of a face -> muscles, head motion, overlay, report",
    ),
    "refine": (
        "mimetic.commands.refine",
        "a performance solved again around corrected frames, in seconds",
    ),
    "fit": (
        "mimetic.commands.fit",
        "video of a face -> the person's head, and the canonical picture",
    ),
    "calibrate": (
        "mimetic.commands.calibrate",
        "a few seconds of a face -> how its skin is held, how strong its muscles are",
    ),
    "head": ("mimetic.commands.head", "video of a head -> its motion alone, overlay, plot"),
    "points": ("mimetic.commands.points", "where pixels of one frame go in all others"),
    "bake": ("mimetic.commands.bake", "a performance -> animated head, .blend or for others"),
    "shapes": ("mimetic.commands.shapes", "a head of any make -> ARKit's 52 blend shapes on it"),
    "analyse": (
        "mimetic.commands.analyse",
        "a performance -> when muscles fire, as tables, figures",
    ),
    "compare": (
        "mimetic.commands.compare",
        "an expression of a performance beside its action unit of FACS",
    ),
    "library": (
        "mimetic.commands.library",
        "expressions kept of performances, mirrored, composed into new ones",
    ),
    "puppet": (
        "mimetic.commands.puppet",
        "a face that drives another: taught from a clip, or filmed by a camera",
    ),
    "evaluate": ("mimetic.commands.evaluate", "score a capture against known truth"),
    "batch": (
        "mimetic.commands.batch",
        "many clips -> a folder each, and a page of them all; here or by a studio's engine",
    ),
    "info": ("mimetic.commands.info", "what is in a performance"),
}
FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130


def main(arguments: Sequence[str] | None = None) -> int:
    words = list(sys.argv[1:] if arguments is None else arguments)
    status, message = _told(lambda: _run_words(words))
    if message:
        say(f"mimetic: {message}")
    return status


def outcome(options: argparse.Namespace) -> tuple[int, str]:
    """Runs a command; returns its exit status, and in one line what went wrong, if anything did."""
    return _told(lambda: _run_options(options))


def _run_words(words: list[str]) -> int:
    try:
        options = _make_parser(words).parse_args(words)
    except SystemExit as request:  # argparse has printed why
        return int(request.code or 0)
    _write_any_name(sys.stdout)
    return _run_options(options)


def _run_options(options: argparse.Namespace) -> int:
    with signals_raised():
        return options.run(options)


def _told(run: Callable[[], int]) -> tuple[int, str]:
    """The exit status that it returns, or that of what it raises, and that in one line."""
    try:
        status = run()
        if sys.stdout is not None:
            sys.stdout.flush()  # what cannot be written fails here, or as Python ends
        return status, ""
    except (InvalidInput, UnreadableMedia) as error:
        return BAD_INPUT, line(error)
    except KeyboardInterrupt as request:
        return getattr(request, "status", INTERRUPTED), "stopped"
    except BrokenPipeError:  # `mimetic info ... | head`
        if sys.stderr is not None:
            sys.stderr.close()
        return FAILED, ""
    except OSError as error:
        name = f"{error.filename}: " if error.filename else ""
        return FAILED, line(f"{name}{error.strerror or error}")
    except MemoryError:
        return FAILED, "not enough memory; scale the footage down"


def options_of(words: Sequence[str]) -> argparse.Namespace:
    """The options of a command line that is known to be right, for `outcome`."""
    return _make_parser(list(words)).parse_args(words)


def _make_parser(arguments: list[str]) -> argparse.ArgumentParser:
    """Only the module of the command that is asked for is imported."""
    parser = argparse.ArgumentParser(
        prog="mimetic",
        description="Video of a face to muscle activations and head motion, for Blender.",
    )
    parser.add_argument("--version", action="version", version=f"mimetic {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    first_word = next((word for word in arguments if not word.startswith("-")), None)
    for name, (module_name, summary) in COMMANDS.items():
        command = commands.add_parser(
            name, help=summary, description=f"{summary[0].upper()}{summary[1:]}."
        )
        if name == first_word:
            module = importlib.import_module(module_name)
            module.add_arguments(command)
            command.set_defaults(run=getattr(module, f"run_{name}"))
    return parser


def _write_any_name(stream: TextIO) -> None:
    """Escapes what the stream's encoding lacks, as in names of files, instead of failing."""
    if hasattr(stream, "reconfigure"):
        stream.reconfigure(errors="backslashreplace")


def line(error: object) -> str:
    """What may hold names of files, in one line that is safe on a terminal."""
    return shown(" ".join(str(error).split()))
