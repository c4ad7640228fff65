# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch: which tasks there are, in a folder with a folder for each."""

from __future__ import annotations

import contextlib
import itertools
import re
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch.clip_list import MARK, Row, is_text
from mimetic.batch.person import FOLDER, is_there, prepare_people
from mimetic.batch.steps import Settings
from mimetic.batch.task import Task
from mimetic.media.image_sequence import is_sequence
from mimetic.shared.folder_lock import alone_with, in_use, remove_left_over
from mimetic.shared.json_file import read_json, write_json
from mimetic.shared.shown_text import UNSAFE, shown
from mimetic.shared.whole_file import HIDDEN

PLAN = "batch.json"
PAGE = "index.html"
TEMPLATE = "template.json"  # of Open Job Description
AT_WORK = f"{HIDDEN}batch-"  # how the name of a folder begins that a batch at work has in use
SCHEMA = 1
LARGEST_FILE = 64 << 20  # bytes
LONGEST_NAME = 80  # characters; folders may have 255 bytes
FORBIDDEN = re.compile(r'[<>:"/\\|?*%{}]')  # in folders of some system, or to engines


@dataclass
class Batch:
    """Tasks in the order of the clips, and clips for which there is none, with the reason."""

    out: Path
    tasks: list[Task]
    problems: list[Row]

    def save(self, names: Sequence[str] = (), problems: Sequence[Row] = ()) -> None:
        """Writes batch.json whole, for `load`; raises OSError.

        names, problems: of other batches' clips, which stand before this one's.
        """
        own_names = [task.name for task in self.tasks]
        own_clips = {row.clip for row in (*self.problems, *(task.row for task in self.tasks))}
        others = [row for row in problems if row.clip not in own_clips]
        document = {
            "schema": SCHEMA,
            "tasks": [*(name for name in names if name not in own_names), *own_names],
            "problems": [[row.clip, row.problem] for row in (*others, *self.problems)],
        }
        write_json(self.out / PLAN, document)


@contextlib.contextmanager
def begun(out: Path, rows: Sequence[Row], settings: Settings) -> Iterator[Batch]:
    """`prepare`s a batch that is at work in the block; another that begins meanwhile joins it.

    The folder's plan is then of the clips of both, and each Batch of its own. Raises OSError.
    """
    with contextlib.ExitStack() as stack:
        with alone_with(out):
            remove_left_over(out.glob(f"{AT_WORK}*"))  # of those that were killed
            is_joining = any(out.glob(f"{AT_WORK}*"))
            mark = stack.enter_context(in_use(lambda: tempfile.mkdtemp(dir=out, prefix=AT_WORK)))
            stack.callback(shutil.rmtree, mark, ignore_errors=True)
            batch = prepare(out, rows, settings, is_joining)
        yield batch


def prepare(out: Path, rows: Sequence[Row], settings: Settings, is_joining: bool = False) -> Batch:
    """Makes a folder and task.json for each clip in `out`, which must be there; saves the batch.

    What a clip's task has done already stays known, also of a clip that was moved or renamed since.
    is_joining: the clips of the plan that is there stay in it. Raises OSError where `out` cannot be
    written.
    """
    batch = Batch(out, [], [])
    others: tuple[list[str], list[Row]] = [], []
    if is_joining:
        with contextlib.suppress(InvalidInput, UnreadableMedia):  # none, or none of use
            others = _read(out)
    names = {PLAN, PAGE, FOLDER, TEMPLATE, *map(str.lower, others[0])}
    prepare_people(out, rows)
    folders, left = _known_folders(out)
    for row in rows:
        if row.problem and not (Path(row.clip).is_file() and all(map(is_text, astuple(row)))):
            # For a name that is no text there is no task.json that could be read again
            batch.problems.append(Row(_as_text(row.clip), problem=_as_text(row.problem)))
            continue
        before = folders.get(row.identity)  # of rows that differ by their fit alone there are more
        name = before.pop(0) if before else _left_name(out, row, settings, left)
        name = name or _free_name(out, row, names)
        names.add(name.lower())
        task = Task(out / name, row, settings)
        task.ask()
        batch.tasks.append(task)
    batch.save(*others)
    return batch


def load(out: Path) -> Batch:
    """All that is planned in a folder, of batches that joined each other too.

    Raises InvalidInput, UnreadableMedia.
    """
    names, problems = _read(out)
    batch = Batch(out, [], problems)
    for name in names:
        try:
            batch.tasks.append(Task.load(out / Path(name).name))
        except (InvalidInput, UnreadableMedia) as error:
            batch.problems.append(Row(name, problem=str(error)))
    return batch


def _read(out: Path) -> tuple[list[str], list[Row]]:
    """Names of the tasks, and problems, of a folder's plan; raises as `load`."""
    document = read_json(out / PLAN, "the plan of a batch", LARGEST_FILE)
    try:
        if not isinstance(document, dict) or document["schema"] != SCHEMA:
            raise ValueError(f"its schema is not {SCHEMA}")
        problems = [Row(str(clip), problem=str(problem)) for clip, problem in document["problems"]]
        return [str(name) for name in document["tasks"]], problems
    except (KeyError, TypeError, ValueError) as error:
        raise InvalidInput(f"{out / PLAN}: not the plan of a batch ({error})") from None


def reload(batch: Batch) -> dict[str, str]:
    """Reads again what the tasks have done; returns, by name, why one is not this batch's."""
    failures = {}
    for i, task in enumerate(batch.tasks):
        try:
            batch.tasks[i] = Task.load(task.folder)
            _check_asked(batch.tasks[i], task)
        except (InvalidInput, UnreadableMedia) as error:
            failures[task.name] = str(error)
    return failures


def _check_asked(task: Task, before: Task) -> None:
    """Raises InvalidInput unless the same is asked of a task as before."""
    if (task.row, task.settings) != (before.row, before.settings):
        raise InvalidInput(
            "another batch in this folder has asked for other settings of this clip since: start "
            "this one again, or leave it to the other"
        )


def _as_text(name: str) -> str:
    return name if is_text(name) else shown(name)


def _known_folders(out: Path) -> tuple[dict[tuple[str, str, str], list[str]], list[Task]]:
    """Names of the folders of results by what they are of, in the order of their numbers; and
    tasks whose clips are gone."""
    folders: dict[tuple[str, str, str], list[str]] = {}
    left = []
    for path in sorted(out.glob(f"*/{MARK}"), key=lambda path: (len(path.parent.name), path)):
        try:
            task = Task.load(path.parent)
        except (InvalidInput, UnreadableMedia):
            continue
        folders.setdefault(task.row.identity, []).append(task.name)
        if "capture" in task.done and not is_there(task.row.clip):
            left.append(task)
    return folders, left


def _left_name(out: Path, row: Row, settings: Settings, left: list[Task]) -> str:
    """Takes the folder in which a clip of this content, which is gone, was captured alike.

    Returns its name; the empty string if there is none.
    """
    alike = [task for task in left if task.row.identity[1:] == row.identity[1:]]
    if row.problem or not alike:
        return ""
    try:
        task = Task(out / alike[0].name, row, settings)
        key = task.steps(task.person)[0].key()
    except (InvalidInput, OSError, UnreadableMedia):
        return ""
    found = next((task for task in alike if task.done["capture"]["key"] == key), None)
    if found is None:
        return ""
    left.remove(found)
    return found.name


def _own_name(clip: str) -> str:
    """Without its suffix; of numbered pictures, whose own names are often alike, their folder's."""
    path = Path(clip)
    if not is_sequence(clip):
        return path.stem
    return path.name if path.is_dir() else path.parent.name or path.stem


def _free_name(out: Path, row: Row, names: Iterable[str]) -> str:
    """The clip's own name, with a number where another clip or something else has it.

    Two names that differ by case alone are one to some file systems.
    """
    stem = FORBIDDEN.sub("_", UNSAFE.sub("_", _own_name(row.clip))).strip(". ")[:LONGEST_NAME]
    stem = stem or "clip"
    for number in itertools.count(1):
        name = stem if number == 1 else f"{stem}-{number}"
        if name.lower() not in names and not (out / name).exists():
            return name
    raise AssertionError
