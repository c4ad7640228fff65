# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic library`: expressions kept, mirrored, listed, and composed into new performances."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import numpy as np

from mimetic import InvalidInput, _core
from mimetic.analyse.timing import analyse_timing
from mimetic.commands.blender_process import add_blender_python, write_by_blender
from mimetic.commands.console import Console
from mimetic.commands.on_clip import parse_frames
from mimetic.library.composing import USUAL_FPS, canonical_person, compose, parse_placing
from mimetic.library.cutting import cut_motion
from mimetic.library.expression import Expression
from mimetic.library.folder import Library
from mimetic.library.preview import expression_picture
from mimetic.media.timing import check_rate
from mimetic.performance.document import Performance
from mimetic.shared.counted import counted
from mimetic.shared.regular_file import check_input, check_target
from mimetic.shared.shown_text import shown


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    _add_keep(actions.add_parser("keep", help="cut an expression out of a performance"))
    list_parser = actions.add_parser("list", help="what a library has")
    mirror_parser = actions.add_parser("mirror", help="keep an expression of the other side")
    for one in (list_parser, mirror_parser):
        one.add_argument("library", type=Path, help="folder of expressions")
    mirror_parser.add_argument("name", help="the expression to mirror")
    mirror_parser.add_argument("--as", dest="new_name", required=True, help="name of the new one")
    mirror_parser.add_argument("--replace", action="store_true", help="even if the library has it")
    _add_assets(
        actions.add_parser("assets", help="a .blend of assets, for Blender's Asset Browser")
    )
    _add_compose(actions.add_parser("compose", help="a new performance of kept expressions alone"))


def _add_assets(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("library", type=Path, help="folder of expressions")
    parser.add_argument("--out", type=Path, required=True, help="ASSETS.blend to write")
    add_blender_python(parser)


def _add_keep(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("library", type=Path, help="folder of expressions, made if it is missing")
    parser.add_argument("performance", type=Path, help="performance.npz of a capture")
    parser.add_argument("--name", required=True, help="of the expression in the library")
    parser.add_argument(
        "--frames",
        type=parse_frames,
        metavar="A:B",
        help="first and last frame (default: an event)",
    )
    parser.add_argument(
        "--group",
        type=int,
        choices=range(1, 8),
        metavar="G",
        help="cut an event of this group, 1 to 7 (default: the strongest event of any)",
    )
    parser.add_argument(
        "--event", type=int, metavar="N", help="which of the group's events, as in phases.csv"
    )
    parser.add_argument(
        "--only",
        type=_groups,
        default=(),
        metavar="G,G",
        help="the muscles of these groups alone, without jaw and lids (default: all that moves)",
    )
    parser.add_argument("--still", action="store_true", help="keep the peak alone")
    parser.add_argument(
        "--as-captured",
        action="store_true",
        help="leave values as they are; otherwise the expression begins and ends at rest",
    )
    parser.add_argument("--replace", action="store_true", help="even if the library has it")


def _add_compose(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("library", type=Path, help="folder of expressions")
    parser.add_argument(
        "placings",
        nargs="+",
        metavar="NAME[@START][*STRENGTH][/SECONDS]",
        help="an expression, the second at which it begins to move, its strength, its length",
    )
    parser.add_argument("--out", type=Path, required=True, help="performance.npz to write")
    parser.add_argument(
        "--seconds", type=float, help="that all lasts; starts are stretched with it"
    )
    parser.add_argument("--fps", type=float, default=USUAL_FPS, help="(default: %(default)g)")
    parser.add_argument(
        "--person", type=Path, metavar="PERFORMANCE", help="whose head plays it (default: ours)"
    )
    parser.add_argument(
        "--fading",
        type=float,
        default=_core.CompositionOptions().fading,
        help="how fast an expression loses its say in a muscle that another moves too, away from "
        "its own peak, 1/s (default: %(default)g)",
    )


def run_library(arguments: argparse.Namespace) -> int:
    run = {"keep": _keep, "list": _list, "mirror": _mirror}
    run |= {"compose": _compose, "assets": _assets}
    return run[arguments.action](arguments)


def _keep(arguments: argparse.Namespace) -> int:
    library = Library(arguments.library)
    check_input(arguments.performance, "a performance (the performance.npz of a capture)")
    if arguments.frames and (arguments.group or arguments.event is not None):
        raise InvalidInput("--frames names frames, --group and --event an event: give one of them")
    library.check_new(arguments.name, arguments.replace)
    performance = Performance.load(arguments.performance)
    with Console() as console:
        timing = analyse_timing(performance, console.show, kinds=("group",))
    first, last = arguments.frames or (None, None)
    expression = cut_motion(
        timing,
        frames=_frames(performance, first, last) if arguments.frames else None,
        group=arguments.group,
        number=arguments.event,
        only=arguments.only,
        is_from_rest=not arguments.as_captured,
    )
    if arguments.still:
        expression = expression.still()
    path = library.keep(arguments.name, expression, expression_picture(expression, performance))
    print(f"{shown(path)}: {describe(expression)}")
    return 0


def _list(arguments: argparse.Namespace) -> int:
    library = Library(arguments.library)
    names = library.names()
    width = max(map(len, names), default=0)
    for name in names:
        print(f"{shown(name):{width}}  {describe(library.load(name))}")
    if not names:
        print(f"{shown(arguments.library)} has no expression yet (`mimetic library keep`)")
    return 0


def _mirror(arguments: argparse.Namespace) -> int:
    library = Library(arguments.library)
    expression = library.load(arguments.name).mirrored()
    library.check_new(arguments.new_name, arguments.replace)
    picture = expression_picture(expression, canonical_person())
    path = library.keep(arguments.new_name, expression, picture)
    print(f"{shown(path)}: {describe(expression)}")
    return 0


def _assets(arguments: argparse.Namespace) -> int:
    out = Path(os.path.realpath(arguments.out))
    if out.suffix != ".blend":
        raise InvalidInput(f"--out {out.name}: assets are written as .blend")
    if not Library(arguments.library).names():
        raise InvalidInput(f"{shown(arguments.library)} has no expression (`mimetic library keep`)")
    check_target(out)
    request = {"library": str(arguments.library.absolute())}
    print(f"{shown(arguments.out)}: {write_by_blender(request, out, arguments.blender_python)}")
    return 0


def _compose(arguments: argparse.Namespace) -> int:
    check_rate("--fps", arguments.fps)
    placings = [parse_placing(text) for text in arguments.placings]
    inputs = [] if arguments.person is None else [arguments.person]
    for path in inputs:
        check_input(path, "a performance (the performance.npz of a capture)")
    check_target(arguments.out, *inputs)
    if arguments.out.suffix != ".npz":
        raise InvalidInput(f"--out {arguments.out.name}: a performance is an .npz file")
    options = _core.CompositionOptions()
    options.fading = arguments.fading
    performance = compose(
        placings,
        Library(arguments.library).load,
        Performance.load(arguments.person) if arguments.person else None,
        *(arguments.fps, arguments.seconds, options),
    )
    performance.save(arguments.out)
    for note in performance.notes or ():
        print(f"note: {note}")
    seconds = (performance.num_frames - 1) / performance.fps
    print(
        f"{shown(arguments.out)}: {counted(len(placings), 'expression')}, "
        f"{counted(performance.num_frames, 'frame')}, {seconds:.4g} s"
    )
    return 0


def describe(expression: Expression) -> str:
    """A line: what it is, how long, what moves most, which groups."""
    kind = "still" if expression.is_still else f"motion, {expression.seconds:.2f} s"
    highest = np.abs(expression.values).max(axis=0) * expression.telling
    strongest = [expression.channels[i] for i in np.argsort(-highest)[:3] if highest[i] > 0]
    groups = ", ".join(dict.fromkeys(expression.event_names or ())) or "no phases"
    num = len(expression.channels)
    moved = "1 muscle or bone" if num == 1 else f"{num} muscles and bones"
    source = " of frames ".join(expression.source) if expression.source else "made by hand"
    return (
        f"{kind}; {moved}, most {', '.join(strongest)}; "
        f"{groups if not expression.is_still else 'one moment'}; {source}"
    )


def _frames(performance: Performance, first: int | None, last: int | None) -> tuple[int, int]:
    ends = performance.frame[0], performance.frame[-1]
    return int(ends[0] if first is None else first), int(ends[1] if last is None else last)


def _groups(text: str) -> tuple[int, ...]:
    try:
        groups = tuple(int(word) for word in text.split(","))
    except ValueError:
        groups = ()
    if not groups or not all(1 <= group <= 7 for group in groups):
        raise argparse.ArgumentTypeError(f"{text!r}: groups are numbers from 1 to 7, as in 1,7")
    return groups
