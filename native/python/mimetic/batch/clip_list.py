# SPDX-License-Identifier: GPL-3.0-or-later
"""Which clips a batch is of: files, folders, and tables of both (CSV)."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass, replace
from pathlib import Path

from mimetic import InvalidInput, UnreadableMedia
from mimetic.fit.known_lens import KnownLens
from mimetic.media.clip_fingerprint import MOST_DEPTH, files_in
from mimetic.media.frame_range import parse_range
from mimetic.media.image_sequence import (
    ImageSequence,
    is_sequence,
    picture_before,
    sequences_in,
)
from mimetic.shared.json_file import LONE_SURROGATE
from mimetic.shared.pinhole import FULL_FRAME_MM
from mimetic.shared.regular_file import check_input
from mimetic.shared.results import OF_A_CLIP, PERFORMANCE, UNFINISHED
from mimetic.shared.shown_text import shortened

COLUMNS = ("clip", "fit", "character", "range", "person", "fps", "focal", "sensor")
SUFFIXES = (".mp4", ".mov", ".avi", ".mkv", ".webm", ".m4v", ".mpg", ".mpeg", ".mxf", ".wmv")
LARGEST_TABLE = 16 << 20  # bytes
FEWEST_PICTURES = 12  # on end, to be a clip in a folder that is searched: photographs count up too
MARK = "task.json"  # a folder that has it holds results, not clips


@dataclass(frozen=True)
class Row:
    """A clip and what is said of it; paths are absolute."""

    clip: str  # a video file, or numbered pictures: their folder, a pattern, the first of them
    frames: str = ""  # A:B
    fit: str = ""  # a face fit of this footage; of other footage where `person` is named too
    character: str = ""  # RIG.blend:OBJECT
    person: str = ""
    problem: str = ""  # why it cannot be captured
    fps: str = ""  # of numbered pictures
    focal: str = ""  # mm, of the lens that it was filmed with, if that is known
    sensor: str = ""  # mm, its width

    @property
    def identity(self) -> tuple[str, str, str]:
        """What keeps its folder of results when settings change."""
        return self.clip, self.frames, self.character


def rows_of(
    arguments: Iterable[Path],
    frames: str = "",
    character: str = "",
    fps: str = "",
    focal: str = "",
    sensor: str = "",
) -> list[Row]:
    """The clips of some files, folders and tables, in order; what is missing has a `problem`.

    All but the files are of the clips for which no table says otherwise; a lens is taken from one
    place whole. Raises InvalidInput for a table that cannot be understood.
    """
    rows: list[Row] = []
    usual = Row("", frames, character=character, fps=fps, focal=focal, sensor=sensor)
    for path in _without_later_pictures(arguments):
        if path.is_dir():
            rows += _in_folder(path, usual)
        elif path.suffix.lower() == ".csv":
            rows += _in_table(path, usual)
        else:
            rows.append(_checked(replace(usual, clip=_absolute(path))))
    return list(dict.fromkeys(rows))  # one that is named twice is done once


def _without_later_pictures(paths: Iterable[Path]) -> list[Path]:
    """A shell names all pictures of a sequence for `shot/*.png`: the first stands for them."""
    paths = list(paths)
    given = set(paths)
    return [path for path in paths if picture_before(path) not in given]


def _in_folder(folder: Path, usual: Row) -> Iterator[Row]:
    files = [
        path
        for path in files_in(folder, MOST_DEPTH, with_dead_links=True)
        if not path.name.startswith(".") and not _is_result(path, folder)
    ]
    videos = [path for path in files if path.suffix.lower() in SUFFIXES]  # or dead links to such
    pictures = [path for path in files if path.exists()]
    clips = sorted([*videos, *sequences_in(pictures, FEWEST_PICTURES)])
    if not clips:
        kinds = f"{', '.join(SUFFIXES)}, or {FEWEST_PICTURES} numbered pictures"
        yield Row(_absolute(folder), problem=f"no clips in this folder ({kinds})")
    for path in clips:
        yield _checked(replace(usual, clip=_absolute(path)))


def _is_result(path: Path, folder: Path) -> bool:
    """Whether a batch or a capture has written it, or it lies in a hidden folder."""
    between = [parent for parent in path.parents if folder in (parent, *parent.parents)]
    is_hidden = any(parent.name.startswith(".") for parent in between if parent != folder)
    return is_hidden or _is_of_capture(path) or any((parent / MARK).exists() for parent in between)


def _is_of_capture(path: Path) -> bool:
    folders = [path.parent]
    if path.parent.name.startswith(UNFINISHED):
        folders.append(path.parent.parent)
    return path.name in OF_A_CLIP and any((one / PERFORMANCE).exists() for one in folders)


def _in_table(path: Path, usual: Row) -> Iterator[Row]:
    folder = path.absolute().parent
    table = _records(path)
    if table is None:
        yield Row(_absolute(path), problem="there is no such table of clips")
        return
    for number, record in table:
        has_lens = record.get("focal") or record.get("sensor")
        row = Row(
            _absolute(folder / record["clip"]) if record["clip"] else "",
            record.get("range") or usual.frames,
            _absolute(folder / record["fit"]) if record.get("fit") else "",
            _beside(folder, record.get("character") or "") or usual.character,
            record.get("person") or "",
            fps=record.get("fps") or usual.fps,
            focal=record.get("focal", "") if has_lens else usual.focal,
            sensor=record.get("sensor", "") if has_lens else usual.sensor,
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
    return replace(row, problem=_problem_of(row))


def _problem_of(row: Row) -> str:
    if not all(map(is_text, astuple(row))):
        return "its name is no text (not UTF-8): rename it"
    rig, _, _ = row.character.rpartition(":")
    files = [(row.fit, "a face fit"), (rig, "the .blend of a rig")]
    try:
        if row.character:
            check_character(row.character)
        if is_sequence(row.clip):
            ImageSequence(row.clip, _rate(row.fps))
        else:
            files.insert(0, (row.clip, "a video file"))
        for path, what in files:
            if path:
                check_input(path, what)
        if row.frames:
            parse_range(row.frames)
        check_lens(row)
    except (InvalidInput, UnreadableMedia) as error:
        return str(error)
    return ""


def check_character(character: str) -> None:
    """Raises InvalidInput for what is not RIG.blend:OBJECT."""
    rig, _, name = character.rpartition(":")
    if not (name and rig.endswith(".blend")):
        raise InvalidInput(f"character {character}: give it as RIG.blend:OBJECT")


def is_text(name: str) -> bool:
    """Whether it can be in the documents, which are UTF-8; names of files can be anything."""
    return not LONE_SURROGATE.search(name)


def _rate(text: str) -> float | None:
    """Raises InvalidInput."""
    try:
        return float(text) if text else None
    except ValueError:
        raise InvalidInput(f"fps {text}: give frames a second, such as 23.976") from None


def check_lens(row: Row) -> None:
    """Raises InvalidInput."""
    if row.sensor and not row.focal:
        raise InvalidInput(f"sensor {row.sensor} is of a focal length: give focal too")
    try:
        numbers = [float(text) for text in (row.focal, row.sensor) if text]
    except ValueError:
        raise InvalidInput(
            f"focal {row.focal}, sensor {row.sensor}: give millimetres, such as 35 and 23.5"
        ) from None
    if numbers:
        KnownLens(*numbers, *([FULL_FRAME_MM] * (2 - len(numbers))))


def lens_words(focal: str, sensor: str) -> list[str]:
    """Of a command line that finds a face."""
    words = [f"--focal={focal}"] if focal else []
    return words + ([f"--sensor={sensor}"] if sensor else [])


def _beside(folder: Path, character: str) -> str:
    """RIG.blend:OBJECT with the rig's path seen from the table's folder."""
    rig, separator, name = character.rpartition(":")
    return f"{_absolute(folder / rig)}{separator}{name}" if rig else character


def _absolute(path: Path) -> str:
    return os.path.abspath(path)
