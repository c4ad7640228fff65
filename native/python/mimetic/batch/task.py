# SPDX-License-Identifier: GPL-3.0-or-later
"""A task: one clip, its folder of results, and `task.json` there, which says what is to be done
and what is done. Whoever runs it, and however often, gets the same files.

Two write that file: who prepares the batch what is asked (`ask`), also while a process is at work,
and that process what is done (`save`). Each leaves the other's part as it is.
"""

from __future__ import annotations

import contextlib
import filecmp
import itertools
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from mimetic import InvalidInput, UnreadableMedia
from mimetic.batch.clip_list import MARK, Row
from mimetic.batch.person import BAD_INPUT, Person, folder_of
from mimetic.batch.steps import BAKES, Settings, Step, steps_of
from mimetic.batch.take_summary import is_summary, summarise
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.shared.folder_lock import alone_with, remove_left_over
from mimetic.shared.json_file import read_json, write_json
from mimetic.shared.shown_text import shortened
from mimetic.shared.whole_file import HIDDEN

SCHEMA = 1
LARGEST_FILE = 1 << 20  # bytes
LOCK = ".lock"
FAILED = 1  # exit status, beside BAD_INPUT
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
    # Fingerprints of results as we left them, by name: one that differs was changed by hand
    written: dict[str, str] = field(default_factory=dict)
    begun: str = ""  # the step at work
    error: str = ""  # why it ended last time
    take: dict[str, Any] = field(default_factory=dict)  # `take_summary.summarise`
    # Results that were changed by hand and put aside: name of the copy, and of the result
    kept: dict[str, str] = field(default_factory=dict)

    @property
    def name(self) -> str:
        return self.folder.name

    @property
    def person(self) -> Person | None:
        """Whose fit the clip shares; raises UnreadableMedia, InvalidInput."""
        if not self.row.person or self.row.fit:
            return None
        return Person.load(folder_of(self.folder.parent, self.row.person))

    @property
    def notes(self) -> list[str]:
        """On results that were put aside, as long as they are there."""
        notes = []
        for copy, name in self._kept_yet().items():
            notes.append(f"{name} was changed by hand and is kept as {copy}")
        return notes

    def _kept_yet(self) -> dict[str, str]:
        return {c: name for c, name in self.kept.items() if os.path.exists(self.folder / c)}

    def steps(self, person: Person | None = None) -> list[Step]:
        return steps_of(self.row, self.settings, self.folder, person)

    def has_all(self) -> bool:
        """Whether every step was done as it is asked now, and left its files.

        Of a step whose input is gone since, which cannot be told, its files are enough.
        """
        try:
            person = self.person
        except (InvalidInput, UnreadableMedia):
            return False
        if person and not (person.is_known() or person.has_lost_sources()):
            return False
        return all(self._is_done(step, if_gone=True) for step in self.steps(person))

    def has_results(self, step: Step) -> bool:
        """Whether the step was done, and its files are there."""
        return step.name in self.done and all(
            (self.folder / name).is_file() for name in step.outputs
        )

    def ask(self) -> None:
        """Writes what is asked; what is done stays as it is known. Raises OSError."""
        self.folder.mkdir(exist_ok=True)
        with alone_with(self.folder):
            with contextlib.suppress(InvalidInput, UnreadableMedia):  # none, or none of use
                before = Task.load(self.folder)
                self.done, self.written, self.begun = before.done, before.written, before.begun
                self.take, self.kept = before.take, before.kept
            self._write(self)
        (self.folder / LOCK).touch()

    def save(self) -> None:
        """Writes what is done; what is asked stays as it was asked last. Raises OSError."""
        with alone_with(self.folder):
            asked = self
            with contextlib.suppress(InvalidInput, UnreadableMedia):
                asked = Task.load(self.folder)
            self._write(asked)

    def _write(self, asked: Task) -> None:
        document = {
            "schema": SCHEMA,
            "clip": asdict(asked.row),
            "settings": asdict(asked.settings),
            "done": self.done,
            "written": self.written,
            "begun": self.begun,
            "error": self.error,
            "take": self.take,
            "kept": self._kept_yet(),
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
        return self._is_done(step, if_gone=False)

    def _is_done(self, step: Step, if_gone: bool) -> bool:
        """if_gone: whether a step with results counts as done where an input of it is gone."""
        if not self.has_results(step):
            return False
        try:
            return self.done[step.name]["key"] == step.key()
        except (OSError, UnreadableMedia):
            return if_gone

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
    written = document.get("written")
    if written is None:  # by a Mimetic that kept them of steps that were done alone
        written = {n: f for record in document["done"].values() for n, f in record["files"].items()}
    if not all(isinstance(mark, str) for mark in written.values()):
        raise TypeError("written holds what is no fingerprint")
    kept = document.get("kept")
    if kept is None:  # by a Mimetic that kept the notes on them
        kept = dict(
            reversed(note.split(" was changed by hand and is kept as "))
            for note in document["notes"]
        )
    texts = [document["error"], document["begun"], *kept, *kept.values()]
    if not all(isinstance(text, str) for text in texts) or not is_summary(document["take"]):
        raise TypeError("error, begun, kept or take of another type")
    rest = {name: document[name] for name in ("done", "begun", "error", "take")}
    rest |= {"row": row, "settings": Settings(**settings), "written": written, "kept": kept}
    return rest


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
        remove_left_over(folder.glob(f"{HIDDEN}*"))
        try:
            status, message = _run_steps(task, run_command, only)
        except (InvalidInput, UnreadableMedia) as error:
            status, message = BAD_INPUT, str(error)
        except OSError as error:
            name = f"{error.filename}: " if error.filename else ""
            status, message = FAILED, f"{name}{error.strerror or error}"
        task.begun, task.error = "", "" if status > STOPPED else message
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
    _put_aside(task, step)
    task.begun, task.error = step.name, ""
    record = task.done.pop(step.name, None)
    task.save()
    start = time.monotonic()
    status, message = run_command(step.words)
    if status:
        if record is not None and _are_of(task.folder, record["files"], step.outputs):
            task.done[step.name] = record  # the results of the settings before are there still
        elif step.leaves_parts:
            task.written |= {
                name: fingerprint(task.folder / name)
                for name in step.outputs
                if (task.folder / name).is_file()
            }
        return status, message
    files = {name: fingerprint(task.folder / name) for name in step.outputs}
    seconds = round(time.monotonic() - start, 3)
    task.done[step.name] = {"key": key, "files": files, "seconds": seconds}
    task.written |= files
    _remove_equal_copies(task, step)
    if step.name == "capture":
        task.take = summarise(task.folder, Path(task.row.clip))
    task.begun = ""
    task.save()
    return 0, ""


def _put_aside(task: Task, step: Step) -> None:
    """Renames results that are not as we left them, and notes it.

    A process that was killed may have written them, or a person: nothing tells which.
    """
    for name in step.outputs:
        path = task.folder / name
        if path.is_file() and not _are_of(task.folder, task.written, [name]):
            new_path = next(copy for copy in _copies(path) if not copy.exists())
            os.rename(path, new_path)
            task.kept[new_path.name] = name


def _remove_equal_copies(task: Task, step: Step) -> None:
    """Removes what was put aside and is as the new results: a killed process had written it."""
    for name in step.outputs:
        path = task.folder / name
        for copy in itertools.takewhile(Path.exists, _copies(path)):
            if task.kept.get(copy.name) == name and filecmp.cmp(path, copy, shallow=False):
                copy.unlink()
                del task.kept[copy.name]


def _copies(path: Path) -> Iterator[Path]:
    """Names for a result that is put aside."""
    for number in itertools.count():
        yield path.with_name(f"{path.stem}.kept{number or ''}{path.suffix}")


def _are_of(folder: Path, files: Mapping[str, str], names: Iterable[str]) -> bool:
    """Whether results are there with the fingerprints that `files` gives them."""
    return all(
        (folder / name).is_file() and files.get(name) == fingerprint(folder / name)
        for name in names
    )
