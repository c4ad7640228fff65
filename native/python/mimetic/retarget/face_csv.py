# SPDX-License-Identifier: GPL-3.0-or-later
"""Live Link Face's table: 52 units, head and eyes frame by frame, as Unreal and others read.

One line a frame: time code, the number of values, the units from 0 to 1 under ARKit's names with a
capital, then yaw, pitch and roll of head, left and right eye in radians.
"""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput
from mimetic.performance.document import Performance
from mimetic.performance.gaze import gaze_of, has_gaze
from mimetic.performance.head_turn import angles, head_turn
from mimetic.retarget.unit_fit import unit_order, unit_values
from mimetic.shared.regular_file import check_input
from mimetic.shared.shown_text import shortened
from mimetic.shared.whole_file import whole_file

FIRST_COLUMNS = ("Timecode", "BlendShapeCount")
TURNS = tuple(
    f"{part}{axis}" for part in ("Head", "LeftEye", "RightEye") for axis in ("Yaw", "Pitch", "Roll")
)
LARGEST = 500_000_000  # bytes


@dataclass(frozen=True)
class FaceTable:
    """N frames: names of the values, and N x C of them; seconds: N, from midnight."""

    names: tuple[str, ...]
    seconds: NDArray[np.float64]
    values: NDArray[np.float64]


def face_table(performance: Performance) -> FaceTable:
    """A performance in the units that `unit_values` finds; frame 1 of the clip is at 0 seconds.

    Raises InvalidInput for a performance that is not of the canonical mesh.
    """
    return FaceTable(
        (*(name[0].upper() + name[1:] for name in unit_order()), *TURNS),
        _seconds(performance),
        np.hstack([unit_values(performance), _turns(performance)]),
    )


def write_face_csv(performance: Performance, path: str | os.PathLike[str]) -> str:
    """Writes the table, whole or not at all; returns what is in it."""
    return _write(face_table(performance), performance.fps, path)


def write_control_csv(
    performance: Performance,
    names: Sequence[str],
    values: NDArray[np.float64],
    path: str | os.PathLike[str],
) -> str:
    """The same of a character's own controls (N x K), by their names, before the turns of head and
    eyes."""
    table = FaceTable(
        (*names, *TURNS), _seconds(performance), np.hstack([values, _turns(performance)])
    )
    return _write(table, performance.fps, path)


def _write(table: FaceTable, fps: float, path: str | os.PathLike[str]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*FIRST_COLUMNS, *table.names])
    for seconds, row in zip(table.seconds, table.values, strict=True):
        code = time_code(float(seconds), fps)
        writer.writerow([code, len(row), *(f"{value:.8f}" for value in row)])
    with whole_file(Path(path)) as stream:
        stream.write(text.getvalue().encode())
    return f"{len(table.values)} frames of {len(table.names)} values"


def read_face_csv(path: str | os.PathLike[str], fps: float) -> FaceTable:
    """What a table has, by its own names; fps: of its time codes. Raises InvalidInput."""
    path = Path(path)
    check_input(path, "a table of Live Link Face (CSV)")
    if path.stat().st_size > LARGEST:
        raise InvalidInput(f"{path}: larger than {LARGEST / 1e6:.0f} MB")
    rows = csv.reader(path.read_text("utf-8", errors="replace").splitlines())
    head = _first_line(path, rows)
    if tuple(head[:2]) != FIRST_COLUMNS or len(set(head)) < len(head):
        raise InvalidInput(
            f"{path}: a table of Live Link Face begins with {','.join(FIRST_COLUMNS)}"
        )
    seconds, values = [], []
    try:
        for row in rows:
            if len(row) != len(head):
                raise ValueError(f"{len(row)} values, not {len(head)}")
            seconds.append(seconds_of(row[0], fps))
            numbers = [float(text) for text in row[2:]]
            if not np.isfinite(numbers).all():
                raise ValueError("a value is not finite")
            values.append(numbers)
    except (csv.Error, ValueError) as error:
        raise InvalidInput(shortened(f"{path}: line {rows.line_num}: {error}")) from None
    table = np.array(values, dtype=np.float64).reshape(len(values), len(head) - 2)
    return FaceTable(tuple(head[2:]), np.array(seconds, dtype=np.float64), table)


def _first_line(path: Path, rows: Iterator[list[str]]) -> list[str]:
    try:
        return next(rows, [])
    except csv.Error as error:
        raise InvalidInput(shortened(f"{path}: line 1: {error}")) from None


def time_code(seconds: float, fps: float) -> str:
    """HH:MM:SS:FF.mmm, none left out: FF counts the frames of a second, mmm parts of one."""
    whole = int(seconds + 1e-9)
    parts = round(1000 * (seconds - whole) * fps)
    if parts >= 1000 * math.ceil(fps):
        whole, parts = whole + 1, 0
    frame, part = divmod(max(parts, 0), 1000)
    return f"{whole // 3600:02d}:{whole // 60 % 60:02d}:{whole % 60:02d}:{frame:02d}.{part:03d}"


def seconds_of(code: str, fps: float) -> float:
    """The inverse of `time_code`; raises ValueError."""
    parts = code.split(":")
    if len(parts) != 4:
        raise ValueError(f"{code!r} is no time code HH:MM:SS:FF.mmm")
    hours, minutes, seconds, frames = (float(part) for part in parts)
    if not math.isfinite(hours + minutes + seconds + frames):
        raise ValueError(f"{code!r} is not a finite time")
    return 3600 * hours + 60 * minutes + seconds + frames / fps


def _seconds(performance: Performance) -> NDArray[np.float64]:
    return (np.asarray(performance.frame) - 1) / performance.fps


def _turns(performance: Performance) -> NDArray[np.float64]:
    """N x 9 radians; ARKit's eyes turn as heads do: pitch is positive downwards."""
    heads = np.array([angles(head_turn(pose)) for pose in np.asarray(performance.head_pose)])
    eyes = np.zeros((performance.num_frames, 6))
    if has_gaze(performance):
        eyes[:, [0, 1, 3, 4]] = np.radians(gaze_of(performance)) * (1, -1, 1, -1)
    return np.hstack([heads, eyes])
