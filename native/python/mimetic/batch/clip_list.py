# SPDX-License-Identifier: GPL-3.0-or-later
"""Which clips a batch is of: files, folders, and tables of both (CSV)."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.media.clip_fingerprint import MOST_DEPTH, files_in
from mimetic.media.frame_range import parse_range
from mimetic.shared.regular_file import check_input
from mimetic.shared.shown_text import shortened

COLUMNS = ("clip", "fit", "character", "range", "person")
SUFFIXES = (".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".mxf", ".wmv")
LARGEST_TABLE = 16 << 20  # bytes
MARK = "task.json"  # a folder that has it holds results, not clips


@dataclass(frozen=True)
class Row:
    """A clip and what is said of it; paths are absolute."""

    clip: str
    frames: str = ""  # A:B
    fit: str = ""  # a face fit of this footage; of other footage where `person` is named too
    character: str = ""  # RIG.blend:OBJECT
    person: str = ""
    problem: str = ""  # why it cannot be captured

    @property
    def identity(self) -> tuple[str, str, str]:
        """What keeps its folder of results when settings change."""
        return self.clip, self.frames, self.character


def rows_of(arguments: Iterable[Path], frames: str = "", character: str = "") -> list[Row]:
    """The clips of some files, folders and tables, in order; what is missing has a `problem`.

    frames, character: of the clips for which no table says otherwise. Raises InvalidInput for a
    table that cannot be understood.
    """
    rows: list[Row] = []
    for path in arguments:
        if path.is_dir():
            rows += _in_folder(path, frames, character)
        elif path.suffix.lower() == ".csv":
            rows += _in_table(path, frames, character)
        else:
            rows.append(_checked(Row(_absolute(path), frames, character=character)))
    return list(dict.fromkeys(rows))  # one that is named twice is done once


def _in_folder(folder: Path, frames: str, character: str) -> Iterator[Row]:
    clips = sorted(
        path
        for path in files_in(folder, MOST_DEPTH)
        if path.suffix.lower() in SUFFIXES
        and not path.name.startswith(".")
        and not _is_result(path, folder)
    )
    if not clips:
        yield Row(_absolute(folder), problem=f"no clips in this folder ({', '.join(SUFFIXES)})")
    for path in clips:
        yield _checked(Row(_absolute(path), frames, character=character))


def _is_result(path: Path, folder: Path) -> bool:
    """Whether a batch has written it, or it lies in a hidden folder."""
    between = [parent for parent in path.parents if folder in (parent, *parent.parents)]
    is_hidden = any(parent.name.startswith(".") for parent in between if parent != folder)
    return is_hidden or any((parent / MARK).exists() for parent in between)


def _in_table(path: Path, frames: str, character: str) -> Iterator[Row]:
    folder = path.absolute().parent
    table = _records(path)
    if table is None:
        yield Row(_absolute(path), problem="there is no such table of clips")
        return
    for number, record in table:
        row = Row(
            _absolute(folder / record["clip"]) if record["clip"] else "",
            record.get("range") or frames,
            _absolute(folder / record["fit"]) if record.get("fit") else "",
            _beside(folder, record.get("character") or "") or character,
            record.get("person") or "",
        )
        if not row.clip:
            yield Row(f"{path.name}, line {number}", problem="the line names no clip")
        else:
            yield _checked(row)


def _records(path: Path) -> list[tuple[int, dict[str, str]]] | None:
    """Line number and columns of each line that is not empty; None where there is no file."""
    if not path.exists():
        return None
    check_input(path, "a table of clips (CSV)")
    if path.stat().st_size > LARGEST_TABLE:
        raise InvalidInput(f"{path}: larger than {LARGEST_TABLE >> 20} MiB: no table of clips")
    try:
        text = path.read_bytes().decode("utf-8-sig")
        lines = csv.reader(io.StringIO(text), strict=True)
        header = [name.strip().lower() for name in next(lines, [])]
        _check_header(path, header)
        records = []
        for cells in lines:
            values = [cell.strip() for cell in cells]
            if not any(values):
                continue
            if len(values) > len(header):
                raise InvalidInput(
                    f"{path}, line {lines.line_num}: {len(values)} columns, the header has "
                    f"{len(header)}; put names with commas in quotes"
                )
            values += [""] * (len(header) - len(values))
            records.append((lines.line_num, dict(zip(header, values, strict=True))))
    except UnicodeDecodeError:
        raise InvalidInput(f"{path}: not UTF-8 text: save the table as CSV in UTF-8") from None
    except csv.Error as error:
        raise InvalidInput(f"{path}, line {lines.line_num}: no CSV ({error})") from None
    return records


def _check_header(path: Path, header: list[str]) -> None:
    strange = [name for name in header if name not in COLUMNS]
    if "clip" not in header or strange or len(set(header)) < len(header):
        names = shortened(", ".join(map(repr, header)) or "nothing")
        raise InvalidInput(
            f"{path}: the first line must name the columns, 'clip' and any of "
            f"{', '.join(COLUMNS[1:])}; it has {names}"
        )


def _checked(row: Row) -> Row:
    """The row, with the problem that can be seen before any work."""
    return Row(*row.identity[:2], row.fit, row.character, row.person, _problem_of(row))


def _problem_of(row: Row) -> str:
    rig, _, name = row.character.rpartition(":")
    if row.character and not (name and rig.endswith(".blend")):
        return f"character {row.character}: give it as RIG.blend:OBJECT"
    files = [(row.clip, "a video file"), (row.fit, "a face fit"), (rig, "the .blend of a rig")]
    try:
        for path, what in files:
            if path:
                path.encode()  # the documents are UTF-8
                check_input(path, what)
        if row.frames:
            parse_range(row.frames)
    except UnicodeEncodeError:
        return "its name is no text (not UTF-8): rename it"
    except (InvalidInput, UnreadableMedia) as error:
        return str(error)
    return ""


def _beside(folder: Path, character: str) -> str:
    """RIG.blend:OBJECT with the rig's path seen from the table's folder."""
    rig, separator, name = character.rpartition(":")
    return f"{_absolute(folder / rig)}{separator}{name}" if rig else character


def _absolute(path: Path) -> str:
    return os.path.abspath(path)
