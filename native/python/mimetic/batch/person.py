# SPDX-License-Identifier: GPL-3.0-or-later
"""A person's fit, which all clips of that person share.

It is the first that one of the person's lines names, otherwise the one found in the first of their
clips that shows the face. Whichever of their tasks comes first finds it, the others wait; it is the
same whoever that is.

Two write person.json: who prepares the batch the clips that may give the fit, and who looks for it
the fit, or why there is none. Each leaves the other's part as it is.
"""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import json
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from mimetic import InvalidInput, UnreadableMedia, __version__
from mimetic.batch.clip_list import Row, lens_words
from mimetic.media.clip_fingerprint import fingerprint
from mimetic.media.image_sequence import opened
from mimetic.shared.folder_lock import alone_with
from mimetic.shared.json_file import read_json, write_json
from mimetic.shared.shown_text import shortened

FOLDER = "people"  # beside the clips' folders
MARK = "person.json"
LOCK = ".lock"
SCHEMA = 2
LARGEST_FILE = 16 << 20  # bytes
BAD_INPUT = 2  # exit status
RunCommand = Callable[[Sequence[str]], tuple[int, str]]
# A clip, its range of frames, a fit of it, focal length and sensor's width of its lens
Source = tuple[str, str, str, str, str]


@dataclass
class Person:
    folder: Path
    sources: list[Source] = field(default_factory=list)
    key: str = ""  # of what the fit was found in
    fit: str = ""  # the file
    footage: str = ""  # fingerprint of the clip that the fit is of
    failed_key: str = ""  # of the sources, none of which shows the face
    reason: str = ""  # why not, of the last

    def ask(self) -> None:
        """Writes where to look for the fit; what was found stays known. Raises OSError.

        That none was found does not, as clips that failed are tried again too.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        with alone_with(self.folder):
            with contextlib.suppress(InvalidInput, UnreadableMedia):  # none, or none of use
                before = Person.load(self.folder)
                self.key, self.fit, self.footage = before.key, before.fit, before.footage
            self._write(self.sources)
        (self.folder / LOCK).touch()

    def save(self) -> None:
        """Writes what was found; where to look stays as it was asked last. Raises OSError."""
        with alone_with(self.folder):
            sources = self.sources
            with contextlib.suppress(InvalidInput, UnreadableMedia):
                sources = Person.load(self.folder).sources
            self._write(sources)

    def _write(self, sources: Sequence[Source]) -> None:
        document = {
            "schema": SCHEMA,
            "sources": sources,
            "key": self.key,
            "fit": self.fit,
            "footage": self.footage,
            "failed": {"key": self.failed_key, "reason": self.reason},
        }
        write_json(self.folder / MARK, document)

    @classmethod
    def load(cls, folder: Path) -> Person:
        """Raises UnreadableMedia where there is no person, InvalidInput for what is none."""
        path = folder / MARK
        document: Any = read_json(path, "a person of a batch", LARGEST_FILE)
        try:
            if document["schema"] != SCHEMA:
                raise ValueError(f"schema {document['schema']}, this Mimetic knows {SCHEMA}")
            sources = [
                (c, f, fit, focal, sensor) for c, f, fit, focal, sensor in document["sources"]
            ]
            texts = [document[name] for name in ("key", "fit", "footage")]
            if failed := document.get("failed"):  # none by a Mimetic that did not keep it
                texts += [failed["key"], failed["reason"]]
            if not all(isinstance(text, str) for text in itertools.chain(texts, *sources)):
                raise TypeError("not texts alone")
            return cls(folder, sources, *texts)
        except (KeyError, TypeError, ValueError) as error:
            raise InvalidInput(f"{path}: not a person of a batch ({shortened(error)})") from None

    def is_of(self, clip: str) -> bool:
        """Whether the fit is of this very footage."""
        return self.footage == _content(clip)

    def is_known(self) -> bool:
        """Whether the fit is there and was found in what the sources still are."""
        return bool(self.key) and os.path.isfile(self.fit) and self._key_of(self.fit) == self.key

    def has_lost_sources(self) -> bool:
        """Whether some of what a fit was found in is gone, so that it cannot be known again."""
        paths = [path for clip, _, fit, *_ in self.sources for path in (clip, fit) if path]
        return bool(self.key) and not all(map(is_there, paths))

    def find(self, run_command: RunCommand) -> str:
        """Finds the fit where it is not known; returns why there is none, or nothing.

        Where no source shows the face they are searched again when one of them changed, or the
        fit is asked for anew. Another process that looks for it is waited for. Raises OSError.
        """
        with alone_with(self.folder / LOCK):
            now = Person.load(self.folder)
            if now.is_known():
                reason = ""
            elif now.failed_key and now.failed_key == now._key_of(""):
                reason = now.reason
            else:
                reason = now._search(run_command)
        self.key, self.fit, self.footage = now.key, now.fit, now.footage
        return reason

    def _search(self, run_command: RunCommand) -> str:
        reason = "no clip shows the person"
        would_fail_again = True
        for clip, frames, given_fit, focal, sensor in self.sources:
            words = ["fit", clip, "--out", str(self.folder)]
            words += [f"--frames={frames}"] if frames else []
            words += lens_words(focal, sensor)
            fit = given_fit or str(self.folder / "fit.json")
            status, message = (0, "") if given_fit else run_command(words)
            if status > BAD_INPUT:
                raise KeyboardInterrupt
            if status == 0 and (mark := _content(clip)):
                self.fit, self.footage = fit, mark
                self.key = self._key_of(fit)
                self.failed_key = self.reason = ""
                self.save()
                return ""
            reason = message or reason
            would_fail_again &= status == BAD_INPUT
        if would_fail_again:
            self.failed_key, self.reason = self._key_of(""), reason
            self.save()
        return reason

    def _key_of(self, fit: str) -> str:
        """Of all that decides on the fit: the sources up to the one that gave it, or all."""
        parts: list[object] = [__version__]
        for clip, frames, given_fit, *lens in self.sources:
            mark = _content(clip)
            parts.append([mark, frames, _content(given_fit) if given_fit else "", *lens])
            if fit and mark == self.footage and fit in (given_fit, str(self.folder / "fit.json")):
                break
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def prepare_people(out: Path, rows: Iterable[Row]) -> None:
    """A folder for each person of a batch, with the clips that may give the fit. Raises OSError."""
    sources: dict[Path, list[Source]] = {}
    for row in rows:
        if row.person and not row.problem:
            folder = folder_of(out, row.person)
            source = (row.clip, row.frames, row.fit, row.focal, row.sensor)
            sources.setdefault(folder, []).append(source)
    for folder, clips in sources.items():
        named_first = sorted(clips, key=lambda source: not source[2])
        Person(folder, named_first).ask()


def folder_of(out: Path, person: str) -> Path:
    """Where a person's fit is: named by a hash where the name cannot be a folder's."""
    name = person.strip().casefold()
    if not name.isalnum() or len(name) > 80:
        name = hashlib.sha256(name.encode()).hexdigest()[:16]
    return out / FOLDER / name


def is_there(path: str) -> bool:
    """Whether a clip, or another file, is where it was."""
    try:
        return os.path.exists(opened(path))
    except UnreadableMedia:
        return False


def _content(path: str) -> str:
    try:
        return fingerprint(opened(path))
    except (OSError, UnreadableMedia):
        return ""
