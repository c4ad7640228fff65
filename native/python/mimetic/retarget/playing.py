# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance as curves of a character's own controls.

Where the character's head has muscles, its controls are fitted to what they do to its surface,
whatever the controls are called. Where names are known they say what to expect; for a head without
muscles, names alone decide, through what the face units do to the canonical head.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, _core
from mimetic.character.shapes import slider_shapes_of
from mimetic.performance.document import Performance
from mimetic.performance.gaze import SIDES, gaze_of, has_gaze
from mimetic.retarget.control_names import (
    is_bone_channel,
    known_names,
    unit_shares,
)
from mimetic.retarget.controls import ControlRow, ControlSurface, refitted
from mimetic.retarget.name_shares import by_shares, shares_once
from mimetic.retarget.unit_fit import NOT_CANONICAL, unit_order, unit_values
from mimetic.template.face_template import load_template

MOVES = 1e-6  # of the mesh's extent: a control that displaces less on this mesh moves nothing of it
DRIVEN = 5e-3  # of a control's range: a curve that stays below is none
MOST_NAMED = 24  # in one list of a message
KEPT = 4  # heads of which it is known what is seen of them
MOST_FITS = 8  # that a preview keeps: one for each choice of controls that are on
SHUTTING, PARTING = ("lid_upper.L", "lid_upper.R"), "jaw_open"  # sources that move rims
# Share of what a muscle does by itself: below it no control stands for it; the fit leaves it out
UNPLAYED = _core.ControlFitOptions().least_explained
STILL_EYE = 1.0  # degrees, of what an eye turns by
READABLE = (
    0.05  # share of a control's motion that a face can make: below it is no control of a face
)

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PlayedControls:
    """Curves of K controls over N frames.

    by_name: controls that their names alone drive; unmatched: controls that nothing drives, as they
    do not move what a face moves and their names are unknown; resting: controls that this
    performance leaves at rest; unplayed: muscles, jaw, lids and gaze that move in it and of which
    the controls make nearly nothing; explained: share of the motion of the surface over all
    frames that the controls make, None where names alone decide; strangers: what a preset has rows
    of and the character has not; doubles: those of by_name that mean what others play, and rest.
    """

    names: list[str]
    values: Floats  # N x K
    by_name: list[str]
    unmatched: list[str]
    resting: list[str]
    unplayed: list[str]
    explained: float | None
    strangers: Sequence[str] = ()
    doubles: Sequence[str] = ()

    def summary(self) -> str:
        """What was driven and what was not, for people: parts between semicolons."""
        driven = len(self.names) - len(self.resting)
        parts = [f"{driven} of {len(self.names) + len(self.unmatched)} controls driven"]
        if self.explained is not None:
            parts.append(f"{max(0.0, self.explained):.0%} of the face's motion explained")
        if self.by_name:
            parts.append(f"{len(self.by_name)} by their names")
        for text, names in (
            ("at rest", self.resting),
            ("unmatched", self.unmatched),
            ("without a control", self.unplayed),
            ("of the preset alone", self.strangers),
        ):
            if names:
                parts.append(f"{text}: {_listed(names, MOST_NAMED)}")
        return "; ".join(parts)


def remarks(rows: Sequence[ControlRow], played: PlayedControls | None) -> dict[str, str]:
    """What to say of each control: how it was fitted, and what its name means."""
    known = known_names(row.control for row in rows)
    texts = {}
    for row in rows:
        name = row.control
        parts = []
        if played is not None and row.is_on:
            if name in played.unmatched:
                parts.append("unmatched: it moves nothing that a face moves")
            elif name in played.names:
                top = float(np.abs(played.values[:, played.names.index(name)]).max(initial=0))
                parts.append("at rest" if name in played.resting else f"up to {top:.2f}")
                parts += ["by its name"] if name in played.by_name else []
                parts += ["others play what it means"] if name in played.doubles else []
        if name in known:
            units = " + ".join(f"{share:g} {unit}" for unit, share in known[name].units.items())
            meaning = units if is_bone_channel(name) else units or "no motion"
            parts.append(": ".join(filter(None, (known[name].convention, meaning))))
        texts[name] = "; ".join(parts)
    return texts


def play(
    performance: Performance,
    surface: ControlSurface,
    rows: Sequence[ControlRow] | None = None,
    options: _core.ControlFitOptions | None = None,
) -> PlayedControls:
    """Fits a character's controls to a performance, frame by frame.

    rows: the table of controls; those off or missing are not driven; None drives all within their
    ranges. Raises InvalidInput if there is nothing to go by: no muscles and no known name.
    """
    table = table_of(surface, rows)
    fitted = _fitted_controls(performance, surface, table, options)
    curves = {
        name: table[name].played(np.ascontiguousarray(column))
        for name, column in zip(fitted.names, fitted.values.T, strict=True)
    }
    return replace(
        fitted,
        values=_columns(performance, curves.values()),
        resting=[name for name, curve in curves.items() if not _is_driven(curve, table[name])],
    )


def _fitted_controls(
    performance: Performance,
    surface: ControlSurface,
    table: Mapping[str, ControlRow],
    options: _core.ControlFitOptions | None,
) -> PlayedControls:
    """Values as they are before a table's rows scale, bend and cut them."""
    used = surface.without(name for name in surface.ranges if name not in table)
    names = list(used.control_names)
    known = known_names(names)
    moves = moving(used)
    shares = shares_once(names, known, moves)
    expected = _by_names(performance, shares)
    gaze = _gaze(performance, used)
    has_muscles = bool(len(used.source_names))
    if expected is None and not has_muscles and shares.any():
        raise InvalidInput(NOT_CANONICAL)
    is_named = unit_shares(names, known).any(axis=1) & (expected is not None)
    if has_muscles:
        # What the eyes' controls take along is as they play
        turning = {name: table[name].played(column) for name, column in gaze.items()}
        fit, values, explained, source_values = _fit(performance, used, expected, options, turning)
        is_matched = moves & (fit.readable > READABLE)
        only_named = is_named & ~moves
        unplayed = _unplayed(fit, used.source_names, source_values, gaze)
        unplayed += _still_eyes(performance, used)
    else:
        if not is_named.any():
            refuse_unknown(names)
        values, explained, unplayed = np.zeros((performance.num_frames, len(names))), None, []
        is_matched, only_named = np.zeros(len(names), bool), is_named
    if expected is not None:
        values[:, only_named] = expected[:, only_named]
    kept = np.flatnonzero(is_matched | only_named)
    curves = {names[k]: values[:, k] for k in kept} | gaze
    return PlayedControls(
        names=list(curves),
        values=_columns(performance, curves.values()),
        by_name=[names[k] for k in np.flatnonzero(only_named)],
        doubles=[names[k] for k in np.flatnonzero(only_named & ~shares.any(axis=1))],
        unmatched=[name for k, name in enumerate(names) if k not in kept],
        resting=[],
        unplayed=unplayed,
        explained=explained,
    )


def _columns(performance: Performance, curves: Iterable[Floats]) -> Floats:
    """N x K of K curves, of which there may be none."""
    return np.array([*curves]).reshape(-1, performance.num_frames).T


def _is_driven(curve: Floats, row: ControlRow) -> bool:
    return bool(np.abs(curve).max(initial=0) > DRIVEN * (row.highest - row.lowest))


def _gaze(performance: Performance, surface: ControlSurface) -> dict[str, Floats]:
    """N values of each control that turns an eye."""
    if surface.gaze is None or not surface.gaze.channels:
        return {}
    angles = (
        gaze_of(performance) if has_gaze(performance) else np.zeros((performance.num_frames, 4))
    )
    columns = surface.gaze.values(angles).T
    return dict(zip(surface.gaze.names, map(np.ascontiguousarray, columns), strict=True))


def _still_eyes(performance: Performance, surface: ControlSurface) -> list[str]:
    """Gaze that moves and turns no eye that the mesh has."""
    if surface.gaze is None or not has_gaze(performance):
        return []
    moves = np.ptp(gaze_of(performance), axis=0).reshape(2, 2).max(axis=1) > STILL_EYE
    return [f"gaze.{side}" for side in surface.gaze.undriven() if moves[SIDES.index(side)]]


def play_units(performance: Performance, units: Iterable[str]) -> PlayedControls:
    """Curves of those of the 52 that a character has, by ARKit's names: what is sent live.

    Raises InvalidInput for a performance that is not of the canonical mesh.
    """
    has = set(units)
    names = [unit for unit in unit_order() if unit in has]
    columns = [unit_order().index(unit) for unit in names]
    values = unit_values(performance)[:, columns]
    is_driven = np.abs(values).max(axis=0, initial=0) > DRIVEN
    return PlayedControls(
        names=names,
        values=values,
        by_name=[],
        unmatched=[],
        resting=[name for name, driven in zip(names, is_driven, strict=True) if not driven],
        unplayed=[],
        explained=None,
    )


class ControlPreview:
    """What `play` makes of a table at any one frame, while the table is edited.

    frames: N, ascending, where the performance's frames lie; options: as `play`. Raises
    InvalidInput if there is nothing to go by.
    """

    def __init__(
        self,
        performance: Performance,
        surface: ControlSurface,
        frames: NDArray[np.float64],
        options: _core.ControlFitOptions | None = None,
    ) -> None:
        self._performance, self._surface = performance, surface
        self._frames, self._options = np.asarray(frames, dtype=np.float64), options
        self._plain = {row.control: row for row in refitted([], surface.ranges)}
        self._fits: dict[frozenset[str], PlayedControls] = {}
        self._fitted(frozenset(self._plain))

    def values(self, frame: float, rows: Sequence[ControlRow]) -> dict[str, float]:
        """Values of the controls that are on, as a bake of this table would show them at a frame.

        Before the first and after the last frame these stay.
        """
        by_name = {row.control: row for row in rows if row.is_on and row.control in self._plain}
        if not by_name:
            return {}
        fit = self._fitted(frozenset(by_name))
        last = len(self._frames) - 1
        place = np.interp(frame, self._frames, np.arange(last + 1))
        before = min(int(place), last)
        share, after = place - before, min(before + 1, last)
        return {
            name: float((1 - share) * ends[0] + share * ends[1])
            for name, column in zip(fit.names, fit.values.T, strict=True)
            for ends in [by_name[name].played(np.ascontiguousarray(column[[before, after]]))]
        }

    def _fitted(self, names: frozenset[str]) -> PlayedControls:
        if names not in self._fits:
            if len(self._fits) >= MOST_FITS:
                self._fits.pop(next(iter(self._fits)))
            table = {name: row for name, row in self._plain.items() if name in names}
            self._fits[names] = _fitted_controls(
                self._performance, self._surface, table, self._options
            )
        return self._fits[names]


def _by_names(performance: Performance, shares: Floats) -> Floats | None:
    """N x K: what names say; None where they say nothing of this performance's mesh."""
    is_canonical = performance.neutral_vertices.shape == load_template().vertices.shape
    if not shares.any() or not is_canonical:
        return None
    return by_shares(unit_values(performance), shares)


def fit_of(
    surface: ControlSurface, options: _core.ControlFitOptions | None = None
) -> _core.ControlFit:
    """Of a character's controls to its muscles; lids and lips touch as muscles have them."""
    areas = _areas(surface)
    return _core.ControlFit(
        surface.controls,
        surface.sources,
        areas,
        surface.control_range,
        surface.source_range,
        options or _core.ControlFitOptions(),
        _rims(surface, areas),
    )


def _areas(surface: ControlSurface) -> Floats:
    """V: what each vertex counts by."""
    if surface.heeds_hidden:
        return _core.polygon_areas(surface.points, *_polygons(surface))
    polygons = (np.asarray(numbers, np.int32).tobytes() for numbers in _polygons(surface))
    return _seen_areas(np.ascontiguousarray(surface.points, np.float64).tobytes(), *polygons)


@lru_cache(maxsize=KEPT)
def _seen_areas(points: bytes, starts: bytes, corners: bytes) -> Floats:
    """As to look at a head from all sides takes longer than to fit its controls."""
    polygons = (np.frombuffer(numbers, np.int32).tolist() for numbers in (starts, corners))
    areas = _core.seen_areas(np.frombuffer(points).reshape(-1, 3), *polygons)
    areas.flags.writeable = False
    return areas


def _rims(surface: ControlSurface, areas: Floats) -> _core.TiedVertices:
    offsets = dict(zip(surface.source_names, surface.sources, strict=True))
    return _core.joined(
        [
            _core.touching_rims(
                surface.points, *_polygons(surface), areas, offsets[name], name != PARTING
            )
            for name in (*SHUTTING, PARTING)
            if name in offsets
        ]
    )


def _fit(
    performance: Performance,
    surface: ControlSurface,
    expected: Floats | None,
    options: _core.ControlFitOptions | None,
    gaze: Mapping[str, Floats],
) -> tuple[_core.ControlFit, Floats, float, Floats]:
    fit = fit_of(surface, options)
    curves = {shape.name: shape.values for shape in slider_shapes_of(performance)} | dict(gaze)
    none = np.zeros(performance.num_frames)
    source_values = np.stack([curves.get(name, none) for name in surface.source_names], axis=1)
    if expected is None:
        expected = np.zeros((performance.num_frames, len(surface.control_names)))
    values = fit.frames(source_values, expected)
    return fit, values, fit.explained(source_values, values), source_values


def _unplayed(
    fit: _core.ControlFit, names: Sequence[str], values: Floats, left_out: Iterable[str]
) -> list[str]:
    moves = np.abs(values).max(axis=0, initial=0) > 0.1
    share = fit.source_explained()
    return [
        name
        for s, name in enumerate(names)
        if moves[s] and share[s] < UNPLAYED and name not in left_out
    ]


def refuse_unknown(names: Sequence[str]) -> NoReturn:
    """Controls of these names cannot be played on a head without muscles: raises InvalidInput."""
    raise InvalidInput(
        "no muscles are attached to the head, and of its controls no name is known "
        f"({_listed(names)}): attach muscles to it first"
    )


def table_of(surface: ControlSurface, rows: Sequence[ControlRow] | None) -> dict[str, ControlRow]:
    """Rows of the controls that are driven, by name; None drives all within their ranges."""
    if rows is not None:
        return {row.control: row for row in rows if row.is_on}
    return {row.control: row for row in refitted([], surface.ranges)}


def moving(surface: ControlSurface) -> NDArray[np.bool_]:
    """Which of the controls move anything of the mesh."""
    extent = float(np.ptp(surface.points, axis=0).max()) if len(surface.points) else 0.0
    reach = np.abs(surface.controls).max(axis=(1, 2), initial=0)
    return reach > MOVES * extent


def _polygons(surface: ControlSurface) -> tuple[list[int], list[int]]:
    return np.asarray(surface.starts).tolist(), np.asarray(surface.corners).tolist()


def _listed(names: Sequence[str], most: int = 6) -> str:
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
