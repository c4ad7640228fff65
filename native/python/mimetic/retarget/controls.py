# SPDX-License-Identifier: GPL-3.0-or-later
"""A character's own controls, and the table of how each is driven, which a preset keeps."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.retarget import gaze_controls
from mimetic.retarget.control_names import is_turned_over, mirrored_name, side_of
from mimetic.shared.json_file import read_json, write_json
from mimetic.shared.shown_text import shortened

FORMAT = "mimetic controls 1"
LARGEST_PRESET = 2_000_000  # bytes
MOST = 1000.0  # of gain, offset and bounds
CURVES = 0.1, 10.0  # least and greatest


@dataclass(frozen=True)
class ControlRow:
    """How one control is driven: gain times what is fitted, plus offset, cut to the range.

    curve: the power to which the fitted value's share of its end of the range is raised first.
    """

    control: str
    is_on: bool = True
    gain: float = 1.0
    offset: float = 0.0
    lowest: float = 0.0
    highest: float = 1.0
    is_edited: bool = False  # by hand: a refit leaves it
    curve: float = 1.0

    def played(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values as fitted (N) to values as played; raises InvalidInput, naming the control."""
        self.check()
        return _core.played_values(
            values, self.gain, self.offset, self.lowest, self.highest, self.curve
        )

    def check(self, where: str = "control") -> None:
        """Raises InvalidInput for bounds that nothing lies between. where: before its name."""
        if not CURVES[0] <= self.curve <= CURVES[1]:
            raise InvalidInput(
                f"{where} ({self.control}): its curve is {self.curve:g}; it lies from "
                f"{CURVES[0]:g} to {CURVES[1]:g}"
            )
        if self.lowest > self.highest:
            raise InvalidInput(
                f"{where} ({self.control}): its range is from {self.lowest:g} to {self.highest:g}"
            )


@dataclass(frozen=True)
class ControlSurface:
    """What a character's controls and muscles do to one mesh of V vertices.

    points: V x 3, at rest; starts, corners: of its polygons; controls: K x V x 3, sources: S x V x
    3, displacements at value 1, in the points' unit and frame; control_range: K x 2; source_names:
    S, of muscles, jaw, lids and gaze as a performance's shapes are called; source_range: S x 2;
    heeds_hidden: False lets what cannot be seen from outside count by a hundredth in the fit.
    gaze: controls beside those that turn the eyes; a source of the same name is what such a control
    leaves of the skin to do: the reverse of what it takes along.
    """

    points: NDArray[np.float64]
    starts: NDArray[np.int32]
    corners: NDArray[np.int32]
    control_names: Sequence[str]
    controls: NDArray[np.float64]
    control_range: NDArray[np.float64]
    source_names: Sequence[str] = ()
    sources: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0, 3)))
    source_range: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))
    heeds_hidden: bool = True
    gaze: gaze_controls.GazeControls | None = None

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Least and greatest value of each control, those that turn eyes last."""
        pairs = zip(self.control_names, self.control_range, strict=True)
        own = {name: (float(low), float(high)) for name, (low, high) in pairs}
        eyes = self.gaze.channels if self.gaze is not None else ()
        return own | {channel.name: (channel.lowest, channel.highest) for channel in eyes}

    def without(self, names: Iterable[str]) -> ControlSurface:
        """The same less some of its controls."""
        left_out = set(names)
        rows = [i for i, name in enumerate(self.control_names) if name not in left_out]
        turning = set(self.gaze.names) & left_out if self.gaze is not None else set()
        kept = [i for i, name in enumerate(self.source_names) if name not in turning]
        return replace(
            self,
            control_names=[self.control_names[i] for i in rows],
            controls=self.controls[rows],
            control_range=self.control_range[rows],
            source_names=[self.source_names[i] for i in kept],
            sources=self.sources[kept],
            source_range=self.source_range[kept],
            gaze=self.gaze.without(turning) if self.gaze is not None else None,
        )


def refitted(rows: Sequence[ControlRow], ranges: Mapping[str, Sequence[float]]) -> list[ControlRow]:
    """The table for controls with these ranges: edited rows stay, others are as at first.

    Rows of controls that the character no longer has are not among them (`waiting`).
    """
    before = {row.control: row for row in rows if row.is_edited}
    return [
        before.get(name) or ControlRow(name, lowest=float(low), highest=float(high))
        for name, (low, high) in ranges.items()
    ]


def waiting(rows: Sequence[ControlRow], ranges: Mapping[str, object]) -> list[ControlRow]:
    """Edited rows of controls that the character does not have now: renamed, or deleted."""
    return [row for row in rows if row.is_edited and row.control not in ranges]


def with_preset(
    rows: Sequence[ControlRow], preset: Sequence[ControlRow]
) -> tuple[list[ControlRow], list[str]]:
    """Rows as a preset has them, edited, where it has them; and what of it no row is for."""
    by_name = {row.control: replace(row, is_edited=True) for row in preset}
    strangers = sorted(by_name.keys() - {row.control for row in rows})
    return [by_name.get(row.control, row) for row in rows], strangers


def mirrored(rows: Sequence[ControlRow], from_side: str = "L") -> list[ControlRow]:
    """Edited rows of one side (L or R) given to the controls of the other, where there are such.

    Of a bone's channel that the mirror turns over, offset and range are turned over too.
    """
    if from_side not in ("L", "R"):
        raise InvalidInput(f"side {from_side!r}: rows are mirrored from L or R")
    by_name = {row.control: row for row in rows}
    twins = {}
    for row in rows:
        twin = mirrored_name(row.control)
        if (
            row.is_edited
            and twin != row.control
            and twin in by_name
            and side_of(row.control) == from_side
        ):
            own = replace(row, control=twin)
            twins[twin] = _turned_over(own) if is_turned_over(twin) else own
    return [twins.get(row.control, row) for row in rows]


def _turned_over(row: ControlRow) -> ControlRow:
    return replace(row, offset=0 - row.offset, lowest=0 - row.highest, highest=0 - row.lowest)


def save_preset(rows: Sequence[ControlRow], path: str | os.PathLike[str]) -> None:
    """Writes a table as JSON, whole or not at all; raises InvalidInput for what could not be read
    again."""
    for row in rows:
        row.check()
    write_json(Path(path), {"format": FORMAT, "controls": [asdict(row) for row in rows]})


def load_preset(path: str | os.PathLike[str]) -> list[ControlRow]:
    """Reads what `save_preset` wrote; raises InvalidInput and UnreadableMedia, naming the file."""
    document = read_json(path, "a preset of controls", LARGEST_PRESET)
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InvalidInput(f'{path}: not a preset of controls: "format" is not "{FORMAT}"')
    entries = document.get("controls")
    if not isinstance(entries, list):
        raise InvalidInput(f'{path}: a preset of controls has a list "controls"')
    rows = [_row(path, number, entry) for number, entry in enumerate(entries, 1)]
    if len({row.control for row in rows}) < len(rows):
        raise InvalidInput(f"{path}: a control is named twice")
    return rows


def _row(path: str | os.PathLike[str], number: int, entry: object) -> ControlRow:
    where = f"{path}: control {number}"
    if not isinstance(entry, dict) or not isinstance(entry.get("control"), str):
        raise InvalidInput(f'{where} has no name ("control")')
    known = {item.name: item.default for item in fields(ControlRow)}
    if strays := sorted(entry.keys() - known.keys()):
        raise InvalidInput(shortened(f"{where} has an unknown {strays[0]!r}"))
    for name, value in entry.items():
        if name == "control":
            continue
        is_truth = isinstance(value, bool)
        if isinstance(known[name], bool) != is_truth:
            raise InvalidInput(shortened(f"{where}: {name} is {value!r}"))
        if not is_truth and not (isinstance(value, int | float) and abs(value) <= MOST):
            raise InvalidInput(shortened(f"{where}: {name} is {value!r}; it lies within {MOST:g}"))
    row = ControlRow(**entry)
    row.check(where)
    return row
