# SPDX-License-Identifier: GPL-3.0-or-later
"""A task: one clip, its folder of results, and `task.json` there, which says what is to be done
and what is done. Whoever runs it, and however often, gets the same files."""

from __future__ import annotations

import contextlib
import itertools
import os
import shutil
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch.clip_list import MARK, Row
from mimetic.batch.person import Person, folder_of
from mimetic.batch.steps import BAKES, Settings, Step, steps_of
from mimetic.batch.take_summary import is_summary, summarise
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.shared.folder_lock import alone_with
from mimetic.shared.json_file import read_json, write_json
from mimetic.shared.shown_text import shortened
from mimetic.shared.whole_file import HIDDEN

SCHEMA = 1
LARGEST_FILE = 1 << 20  # bytes
LOCK = ".lock"
FAILED, BAD_INPUT = 1, 2  # exit status
STOPPED = 128  # above it: by a signal, and to be done yet
# Runs a command line; returns its exit status and what went wrong
RunCommand = Callable[[Sequence[str]], tuple[int, str]]


@dataclass
class Task:
    folder: Path
    row: Row
    settings: Settings
    # By step: {"key": ..., "files": {name: fingerprint}, "seconds": ...}
    done: dict[str, dict[str, Any]] = field(default_factory=dict)
    begun: str = ""  # the step at work when it was last written
    error: str = ""  # why it ended last time
    take: dict[str, Any] = field(default_factory=dict)  # `take_summary.summarise`
    notes: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:
        return self.folder.name

    @property
    def person(self) -> Person | None:
        """Whose fit the clip shares; raises UnreadableMedia, InvalidInput."""
        if not self.row.person or self.row.fit:
            return None
        return Person.load(folder_of(self.folder.parent, self.row.person))

    def steps(self, person: Person | None = None) -> list[Step]:
        return steps_of(self.row, self.settings, self.folder, person)

    def has_all(self) -> bool:
        """Whether every step was done, whatever has become of its input since."""
        return all(step.name in self.done for step in self.steps())

    def save(self) -> None:
        """Writes task.json whole; raises OSError."""
        document = {
            "schema": SCHEMA,
            "clip": asdict(self.row),
            "settings": asdict(self.settings),
            "done": self.done,
            "begun": self.begun,
            "error": self.error,
            "take": self.take,
            "notes": self.notes,
        }
        write_json(self.folder / MARK, document)

    @classmethod
    def load(cls, folder: Path) -> Task:
        """Raises UnreadableMedia where there is no task, InvalidInput for what is none."""
        path = folder / MARK
        document = read_json(path, "the task of a batch", LARGEST_FILE)
        try:
            return cls(folder, **_checked_fields(document))
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise InvalidInput(
                f"{path}: not the task of a batch ({shortened(error)}): remove it, and the clip "
                "is done again"
            ) from None

    def is_done(self, step: Step) -> bool:
        """Whether the step was done with the same input, and its files are there."""
        record = self.done.get(step.name)
        if record is None or not all((self.folder / name).is_file() for name in step.outputs):
            return False
        try:
            return record["key"] == step.key()
        except (OSError, UnreadableMedia):  # an input is gone
            return False

    def is_all_done(self) -> bool:
        try:
            person = self.person
        except (InvalidInput, UnreadableMedia):
            return False
        if self.row.problem or (person and not person.is_known()):
            return False
        return all(map(self.is_done, self.steps(person)))


def _checked_fields(document: Any) -> dict[str, Any]:
    """What Task takes; raises AttributeError, KeyError, TypeError, ValueError."""
    if document["schema"] != SCHEMA:
        raise ValueError(f"schema {document['schema']}, this Mimetic knows {SCHEMA}")
    row, settings = Row(**document["clip"]), dict(document["settings"])
    if not all(isinstance(value, str) for value in asdict(row).values()):
        raise TypeError("clip holds what is no text")
    settings["bakes"] = tuple(settings["bakes"])
    if unknown_bakes := set(settings["bakes"]) - set(BAKES):
        raise ValueError(f"no bake is called {', '.join(map(str, unknown_bakes))}")
    tolerance, python = settings["tolerance"], settings["blender_python"]
    if not isinstance(tolerance, int | float | None) or not isinstance(python, str):
        raise TypeError("settings of another type")
    for record in document["done"].values():
        if not isinstance(record["key"], str) or not isinstance(record["files"], dict):
            raise TypeError("done holds what is no step")
    texts = [document["error"], document["begun"], *document["notes"]]
    if not all(isinstance(text, str) for text in texts) or not is_summary(document["take"]):
        raise TypeError("error, begun, notes or take of another type")
    names = ("done", "begun", "error", "take", "notes")
    return {"row": row, "settings": Settings(**settings)} | {n: document[n] for n in names}


def run_task(folder: Path, run_command: RunCommand, only: Sequence[str] = ()) -> tuple[int, str]:
    """Does what is not done yet of the task in a folder; returns exit status and message.

    only: names of steps; all by default. Another process that does the same task is waited for,
    and what it did is not done again. Raises OSError, InvalidInput, UnreadableMedia where there is
    no task.
    """
    lock = folder / LOCK
    lock.touch()
    with alone_with(lock):
        task = Task.load(folder)
        _remove_left_over(folder)
        try:
            status, message = _run_steps(task, run_command, only)
        except (InvalidInput, UnreadableMedia) as error:
            status, message = BAD_INPUT, str(error)
        except OSError as error:
            name = f"{error.filename}: " if error.filename else ""
            status, message = FAILED, f"{name}{error.strerror or error}"
        task.error = "" if status > STOPPED else message
        with contextlib.suppress(OSError):  # on a full disk whoever waits for us says why
            task.save()
    return status, message


def _run_steps(task: Task, run_command: RunCommand, only: Sequence[str]) -> tuple[int, str]:
    if task.row.problem:
        raise InvalidInput(task.row.problem)
    person = task.person
    if person and (reason := person.find(run_command)):
        raise InvalidInput(f"no fit of {task.row.person}: {reason}")
    for step in task.steps(person):
        if (only and step.name not in only) or task.is_done(step):
            continue
        status, message = _run_step(task, step, run_command)
        if status:
            return status, message
    return 0, ""


def _run_step(task: Task, step: Step, run_command: RunCommand) -> tuple[int, str]:
    key = step.key()
    if task.begun != step.name:
        task.notes += _put_aside(task, step)
    task.begun, task.error = step.name, ""
    record = task.done.pop(step.name, None)
    task.save()
    start = time.monotonic()
    status, message = run_command(step.words)
    if status:
        if record is not None and all(_is_of(task.folder, record, n) for n in step.outputs):
            task.done[step.name] = record  # the results of the settings before are there still
        return status, message
    files = {name: fingerprint(task.folder / name) for name in step.outputs}
    seconds = round(time.monotonic() - start, 3)
    task.done[step.name] = {"key": key, "files": files, "seconds": seconds}
    if step.name == "capture":
        task.take = summarise(task.folder, Path(task.row.clip))
    task.begun = ""
    task.save()
    return 0, ""


def _put_aside(task: Task, step: Step) -> list[str]:
    """Renames results that were changed since they were written; returns notes on them."""
    notes = []
    record = task.done.get(step.name, {"files": {}})
    for name in step.outputs:
        path = task.folder / name
        if path.is_file() and not _is_of(task.folder, record, name):
            new_path = _free_name(path)
            os.rename(path, new_path)
            notes.append(f"{name} was changed by hand and is kept as {new_path.name}")
    return notes


def _is_of(folder: Path, record: dict[str, Any], name: str) -> bool:
    """Whether a file is as a step left it."""
    path = folder / name
    return path.is_file() and record["files"].get(name) == fingerprint(path)


def _free_name(path: Path) -> Path:
    candidates = (
        path.with_name(f"{path.stem}.kept{number or ''}{path.suffix}")
        for number in itertools.count()
    )
    return next(candidate for candidate in candidates if not candidate.exists())


def _remove_left_over(folder: Path) -> None:
    """Removes what a process that was killed had not finished."""
    for path in folder.glob(f"{HIDDEN}*"):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            path.unlink(missing_ok=True)
