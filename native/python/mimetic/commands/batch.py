# SPDX-License-Identifier: GPL-3.0-or-later
"""`mimetic batch`: many clips in; a folder for each and a page of them all out."""

from __future__ import annotations

import argparse
import os
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch import flamenco, on_dask, open_job, plan
from mimetic.batch.clip_list import MARK, Row, check_character, check_lens, is_text, rows_of
from mimetic.batch.page import write_page
from mimetic.batch.plan import PAGE, PLAN, Batch
from mimetic.batch.pool import Outcome, Pool, num_cores
from mimetic.batch.standing import Standing
from mimetic.batch.steps import BAKES, NAMES, Settings
from mimetic.batch.task import run_task
from mimetic.character.sparse_curves import check_tolerance
from mimetic.commands import cli
from mimetic.commands.bake import add_face_arguments
from mimetic.commands.console import Console, say
from mimetic.media.frame_range import parse_range
from mimetic.media.image_sequence import USUAL_FPS, ImageSequence, opened
from mimetic.report.html import check_report_packages
from mimetic.shared.counted import counted
from mimetic.shared.folder_lock import alone_with
from mimetic.shared.interrupts import listen_for_interrupt
from mimetic.shared.pinhole import FULL_FRAME_MM
from mimetic.shared.regular_file import check_input
from mimetic.shared.results import prepare_folder

FAILED = 1  # exit status where a clip failed
PAGE_EVERY = 20  # clips
MOST_NAMED = 12  # of a batch's clips, in one line
PICTURES_LARGER = 10  # about, than frames of a video file


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "clips",
        type=Path,
        nargs="*",
        metavar="CLIPS",
        help="videos, numbered pictures, folders with either, and CSV tables with the column clip "
        "and any of fit, character, range, person, fps, focal, sensor",
    )
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for a folder of each clip"
    )
    parser.add_argument(
        "--frames", default="", metavar="A:B", help="of clips for which no table gives a range"
    )
    parser.add_argument(
        "--fps",
        default="",
        metavar="N",
        help="frames a second of numbered pictures for which no table says it (default: "
        f"{USUAL_FPS})",
    )
    parser.add_argument(
        "--focal",
        default="",
        metavar="MM",
        help="focal length that clips were filmed with for which no table says it, if it is known",
    )
    parser.add_argument(
        "--sensor",
        default="",
        metavar="MM",
        help=f"width of the camera's sensor, of --focal (default: {FULL_FRAME_MM:g}, full frame)",
    )
    _add_bakes(parser)
    _add_running(parser)


def _add_bakes(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--bake",
        nargs="+",
        choices=BAKES,
        default=(),
        metavar="KIND",
        help="bake each clip's face too: blend, glb or both",
    )
    parser.add_argument(
        "--character",
        default="",
        metavar="RIG.blend:OBJECT",
        help="bake each clip on this character, in a copy of its file, as mimetic bake --target",
    )
    add_face_arguments(parser)


def _add_running(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--processes",
        type=int,
        default=num_cores(),
        metavar="N",
        help="clips at a time (default: one a core, %(default)s here)",
    )
    parser.add_argument(
        "--retries",
        type=int,
        default=1,
        metavar="N",
        help="how often a clip is tried again that failed, unless its input is bad "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--submit",
        choices=("flamenco", "openjd", "dask"),
        help="hand the batch to an engine instead: prepare DIR, which all its workers must share, "
        "and submit it",
    )
    parser.add_argument(
        "--address",
        metavar="URL",
        help="of Flamenco's Manager (http://manager:8080), of Dask's scheduler "
        "(tcp://scheduler:8786); nothing is reached without it",
    )
    parser.add_argument(
        "--mimetic",
        default="mimetic",
        metavar="PROGRAM",
        help="how workers call Mimetic (default: %(default)s)",
    )
    parser.add_argument(
        "--summary",
        action="store_true",
        help="run nothing: say how the batch in DIR stands, and write its page again",
    )
    parser.add_argument(
        "--task", metavar="NAME", help="run one clip of the batch that was prepared in DIR"
    )
    parser.add_argument(
        "--steps",
        nargs="+",
        choices=NAMES,
        metavar="STEP",
        default=(),
        help=f"of --task: do these alone, of {', '.join(NAMES)} (default: all that the clip needs)",
    )
    parser.add_argument("--end-with-parent", action="store_true", help=argparse.SUPPRESS)


def run_batch(arguments: argparse.Namespace) -> int:
    """Exit status 0 where every clip is done, 1 where one failed."""
    if arguments.task:
        return run_one(arguments)
    if arguments.steps:
        raise InvalidInput("--steps is of one clip: give --task NAME too")
    if arguments.summary:
        check_input(arguments.out / PLAN, "the plan of a batch (JSON)")
        standing = Standing()
        return tell_outcome(_write_page_anew(arguments.out, {}, standing), {}, standing)
    if not arguments.clips:
        raise InvalidInput("give the clips of the batch: videos, folders, CSV tables")
    if arguments.submit == "dask" and not arguments.address:
        raise InvalidInput("--submit dask needs the scheduler's --address, tcp://scheduler:8786")
    if arguments.address and arguments.submit not in ("flamenco", "dask"):
        raise InvalidInput("--address is of --submit flamenco or dask")
    with begun_batch(arguments) as batch:
        if arguments.submit in ("flamenco", "openjd"):
            return submit(batch, arguments)
        return run(batch, arguments)


def submit(batch: Batch, arguments: argparse.Namespace) -> int:
    """Hands the batch to an engine that goes on without us; returns the exit status."""
    if not batch.tasks:
        tell_outcome(batch, {}, Standing())
        raise InvalidInput("there is no clip to submit")
    for row in batch.problems:
        print(cli.line(f"{row.clip}: {row.problem}"))
    text = (
        f"{counted(len(batch.tasks), 'clip')}; when all is done: "
        f"mimetic batch --summary --out {batch.out}"
    )
    if arguments.submit == "openjd":
        path = open_job.write_template(batch, arguments.mimetic)
        print(cli.line(f"{path}: {text}"))
        print(cli.line(f"submit it: deadline bundle submit {path.parent}"))
    elif arguments.address:
        job = flamenco.submit(batch, arguments.address, arguments.mimetic)
        print(cli.line(f"{arguments.address}: job {job}, {text}"))
    else:
        print(cli.line(f"{batch.out}: prepared, {text}"))
        print(cli.line(f"the job type for Flamenco's Manager: {flamenco.SCRIPT}"))
    return FAILED if batch.problems else 0


def run_one(arguments: argparse.Namespace) -> int:
    """One task, as engines and the batch itself run it."""
    if arguments.end_with_parent:
        threading.Thread(target=_end_with_parent, daemon=True).start()
    if Path(arguments.task).name != arguments.task:
        raise InvalidInput(f"--task {arguments.task}: give the name of a clip's folder in DIR")
    folder = arguments.out / arguments.task
    if not (folder / MARK).is_file():
        names = [task.name for task in plan.load(arguments.out).tasks]
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        raise InvalidInput(
            f"--task {arguments.task}: the batch in {arguments.out} has "
            f"{', '.join(names[:MOST_NAMED]) or 'no clip'}{more}: give one of them, or prepare the "
            "batch again"
        )

    def run_command(words: Sequence[str]) -> tuple[int, str]:
        return cli.outcome(cli.options_of(words))

    status, message = run_task(folder, run_command, arguments.steps)
    if message:
        say(f"mimetic: {message}")
    return status


def _end_with_parent() -> None:
    """Ends this process when its parent is gone, however that was ended."""
    os.read(0, 1)
    os._exit(FAILED)


def begun_batch(arguments: argparse.Namespace) -> AbstractContextManager[Batch]:
    """Checks what is asked for; raises InvalidInput. The batch is prepared as the block begins."""
    check_report_packages()
    if arguments.frames:
        parse_range(arguments.frames)
    if arguments.few_keys is not None:
        check_tolerance(arguments.few_keys)
    if min(arguments.processes, 1 + arguments.retries) < 1:
        raise InvalidInput("--processes counts from 1, --retries from 0")
    python = str(arguments.blender_python.absolute()) if arguments.blender_python else ""
    if not is_text(python):
        raise InvalidInput(
            f"--blender-python {python}: its name is no text (not UTF-8): name it by a link"
        )
    character = arguments.character
    if character:
        check_character(character)
        rig, _, name = character.rpartition(":")
        character = f"{os.path.abspath(rig)}:{name}"
    bakes = tuple(kind for kind in BAKES if kind in arguments.bake)
    settings = Settings(bakes, arguments.detail, arguments.few_keys, python)
    out = Path(os.path.abspath(arguments.out))
    lens = arguments.focal, arguments.sensor
    check_lens(Row("", focal=lens[0], sensor=lens[1]))
    rows = rows_of(arguments.clips, arguments.frames, character, arguments.fps, *lens)
    prepare_folder(out, (PLAN, PAGE))
    return plan.begun(out, rows, settings)


def run(batch: Batch, arguments: argparse.Namespace) -> int:
    """Runs what is not done yet, by processes of this machine or workers of Dask."""
    failures = {task.name: task.row.problem for task in batch.tasks if task.row.problem}
    standing = Standing()
    with Console() as console, listen_for_interrupt("what is done is kept") as interrupt:
        console.show(0.0, "looking at what is done")
        waiting = [
            task for task in batch.tasks if task.name not in failures and not task.is_all_done()
        ]
        num_before = len(batch.tasks) - len(failures) - len(waiting)
        ends: list[str] = []

        def note_end(name: str, outcome: Outcome) -> None:
            ends.append(name)
            if outcome.status and not interrupt():
                failures[name] = outcome.message
                console.tell(f"{name}: {outcome.message}")
            if len(ends) % PAGE_EVERY == 0:
                _refresh(batch.out, failures, standing, console.tell)

        def show(fraction: float, number: int) -> None:
            failure_text = f", {len(failures)} failed" if failures else ""
            console.show(fraction, f"{number} of {counted(len(waiting), 'clip')}{failure_text}")

        weights = {task.name: _weight(Path(task.row.clip)) for task in waiting}
        if arguments.submit == "dask":
            cluster = on_dask.Cluster(arguments.address, arguments.retries, interrupt, note_end)
            cluster.run(batch.out, weights, show)
        else:
            pool = Pool(arguments.processes, arguments.retries, interrupt, note_end)
            command = [sys.executable, "-m", "mimetic", "batch", "--end-with-parent"]
            command += ["--out", str(batch.out)]
            pool.run({name: [*command, f"--task={name}"] for name in weights}, weights, show)
    _refresh(batch.out, failures, standing, lambda text: print(cli.line(text)))
    failures = plan.reload(batch) | failures
    return interrupt.status or tell_outcome(batch, failures, standing, num_before)


def _refresh(
    out: Path, failures: Mapping[str, str], standing: Standing, tell: Callable[[str], None]
) -> None:
    """Writes the page; where that fails the batch goes on."""
    try:
        _write_page_anew(out, failures, standing)
    except OSError as error:
        tell(f"{out / PAGE} cannot be written: {error.strerror or error}")
    except (InvalidInput, UnreadableMedia) as error:
        tell(str(error))


def _write_page_anew(out: Path, failures: Mapping[str, str], standing: Standing) -> Batch:
    """The page of all that is planned in a folder, as it is now, whoever planned it; returns it.

    failures: as for `Standing.why_not`. Raises InvalidInput, UnreadableMedia, OSError.
    """
    with alone_with(out):  # or a page that was read before another's would be written after it
        batch = plan.load(out)
        write_page(batch, failures, standing)
    return batch


def _weight(clip: Path) -> float:
    """What a clip costs beside others: clips of a batch are mostly of one kind."""
    try:
        source = opened(clip)
        if isinstance(source, ImageSequence):
            return max(1.0, source.num_frames * os.stat(source).st_size / PICTURES_LARGER)
        return max(1.0, source.stat().st_size)
    except (OSError, UnreadableMedia):
        return 1.0


def tell_outcome(
    batch: Batch, failures: Mapping[str, str], standing: Standing, num_before: int = 0
) -> int:
    """Prints what failed, a line each, and how many are done; returns the exit status."""
    states = [(task.name, standing.why_not(task, failures)) for task in batch.tasks]
    lines = [(name, "not done yet" if why is None else why) for name, why in states if why != ""]
    num_done = len(states) - len(lines)
    rows = [*lines, *((row.clip, row.problem) for row in batch.problems)]
    for name, reason in rows:
        print(cli.line(f"{name}: {reason}"))
    before = f", {num_before} of them before" if num_before else ""
    failure_text = f", {len(rows)} not" if rows else ""
    done = f"{counted(num_done, 'clip')} done{before}{failure_text}"
    them = "it" if len(states) + len(batch.problems) == 1 else "them"
    print(cli.line(f"{batch.out}: {done}; {PAGE} shows {them}"))
    return FAILED if rows else 0
