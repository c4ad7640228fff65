# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of a batch: its tasks, its people, the tables of clips that people write."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from mimetic.batch.clip_list import MARK, rows_of
from mimetic.batch.page import write_page
from mimetic.batch.person import MARK as PERSON_MARK
from mimetic.batch.person import Person
from mimetic.batch.plan import Batch
from mimetic.batch.standing import Standing
from mimetic.batch.task import Task

CLIP = {
    "clip": "/a/b.mp4",
    "frames": "1:9",
    "fit": "",
    "character": "",
    "person": "",
    "problem": "",
}
TAKE = {
    "frames": [1, 9],
    "num_held": 2,
    "median": 0.9,
    "lowest": 0.1,
    "curve": [0.9, 0.1],
    "shown": 4,
    "notes": ["stopped"],
}
DONE = {"key": "0a", "files": {"performance.npz": "3-0a"}, "seconds": 1.5}
SETTINGS = {"bakes": ["glb"], "with_detail": False, "tolerance": 0.02, "blender_python": ""}
TASK = {"schema": 1, "clip": CLIP, "settings": SETTINGS, "done": {"capture": DONE}, "begun": "glb"}
TASK |= {"error": "Blender failed", "take": TAKE}
TASK |= {"kept": {"face.kept.blend": "face.blend"}}
PERSON = {
    "schema": 2,
    "sources": [["/a/b.mp4", "", "/a/fit.json", "35", ""]],
    "key": "0a",
    "fit": "/a/fit.json",
}
PERSON |= {"footage": "3-0a", "failed": {"key": "0b", "reason": "no face"}}
TABLE = 'clip,fit,character,range,person\na.mp4,,,1:9,anna\n"b,c.mp4",fit.json,rig.blend:Rig,,\n'


def contents() -> dict[str, bytes]:
    """A sound file of each kind."""
    return {
        "task": json.dumps(TASK).encode(),
        "person": json.dumps(PERSON).encode(),
        "table": TABLE.encode(),
    }


def read_task(path: Path) -> None:
    """And on to the page that shows it."""
    with _folder_with(path, MARK) as folder:
        task = Task.load(folder)
        task.is_all_done()
        write_page(Batch(folder.parent, [task], []), {}, Standing())
        task.save()
        # Notes on copies that are not there are left out
        if replace(Task.load(folder), kept=task.kept) != task:
            raise AssertionError("what was saved again is not what was read")


def read_person(path: Path) -> None:
    with _folder_with(path, PERSON_MARK) as folder:
        Person.load(folder).is_known()


def read_table(path: Path) -> None:
    for row in rows_of([path]):
        if not row.clip or not row.problem:
            raise AssertionError(f"{row} cannot be")


@contextlib.contextmanager
def _folder_with(path: Path, name: str) -> Iterator[Path]:
    with TemporaryDirectory() as batch:
        folder = Path(batch, "clip")
        folder.mkdir()
        (folder / name).write_bytes(path.read_bytes())
        yield folder
