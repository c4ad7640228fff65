# SPDX-License-Identifier: GPL-3.0-or-later
"""All that the keys of a curve are, read and written as arrays."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import bpy
import numpy as np

from .. import native
from .actions import BEZIER

PLACES = ("co", "handle_left", "handle_right")
KINDS = ("interpolation", "easing", "handle_left_type", "handle_right_type", "type")
SELECTED = ("select_control_point", "select_left_handle", "select_right_handle")
MARK_DIGITS = 4  # of handles, which Blender may compute again
SHAPES = ("amplitude", "period", "back")  # of easing
IN_TIME = ("CYCLES", "STEPPED")  # modifiers that choose which of the keys' frames is played
DTYPES = (
    dict.fromkeys(KINDS, np.int32)
    | dict.fromkeys(SELECTED, np.bool_)
    | dict.fromkeys(SHAPES, np.float32)
)


@dataclass(frozen=True)
class KeyTable:
    keys: object  # mimetic.character.curve_keys.CurveKeys, K
    columns: dict[str, np.ndarray]  # K each, by the name of a key's property

    def rows(self, which) -> KeyTable:
        """Some of the keys, by indices, a slice or flags."""
        keys = type(self.keys)(*(getattr(self.keys, name)[which] for name in _FIELDS))
        return KeyTable(keys, {name: values[which] for name, values in self.columns.items()})

    def with_keys(self, keys) -> KeyTable:
        """The same kinds of keys elsewhere."""
        return replace(self, keys=keys)

    def is_of(self, name: str, kind: int) -> bool:
        return bool((self.columns[name] == kind).all())


_FIELDS = ("points", "left", "right")


def read(curve: bpy.types.FCurve) -> KeyTable:
    points = curve.keyframe_points
    count = len(points)
    rows = []
    for name in PLACES:
        values = np.empty(2 * count, dtype=np.float32)
        points.foreach_get(name, values)
        rows.append(values.reshape(-1, 2).astype(np.float64))
    columns = {name: np.empty(count, dtype=kind) for name, kind in DTYPES.items()}
    for name, values in columns.items():
        points.foreach_get(name, values)
    return KeyTable(native.curve_keys().CurveKeys(*rows), columns)


def mark(curve: bpy.types.FCurve) -> bytes:
    """What changes with every edit of a curve's keys."""
    table = read(curve)
    kinds = table.columns["interpolation"]
    is_curved = kinds == BEZIER
    handles = [
        np.round(rows[is_curved], MARK_DIGITS).tobytes()
        for rows in (table.keys.left, table.keys.right)
    ]
    return b"".join((table.keys.points.astype(np.float32).tobytes(), kinds.tobytes(), *handles))


def write(curve: bpy.types.FCurve, table: KeyTable) -> None:
    """Gives a curve these keys instead of those that it has."""
    points, count = curve.keyframe_points, len(table.keys.points)
    if len(points) != count:
        points.clear()
        points.add(count)
    for name, values in table.columns.items():
        points.foreach_set(name, values)
    for name, field in zip(PLACES, _FIELDS, strict=True):
        rows = np.ascontiguousarray(getattr(table.keys, field), dtype=np.float32)
        points.foreach_set(name, rows.reshape(-1))
    curve.update()


def joined(tables: list[KeyTable]) -> KeyTable:
    """Keys one after another, in one table."""
    rows = (np.concatenate([getattr(t.keys, name) for t in tables]) for name in _FIELDS)
    names = tables[0].columns
    columns = {name: np.concatenate([t.columns[name] for t in tables]) for name in names}
    return KeyTable(native.curve_keys().CurveKeys(*rows), columns)


def as_cubics(like: KeyTable, keys, handle: int, interpolation: int) -> KeyTable:
    """Keys with handles of one kind, in all else as a table's first one."""
    count = len(keys.points)
    columns = {name: np.repeat(values[:1], count) for name, values in like.columns.items()}
    for name in ("handle_left_type", "handle_right_type"):
        columns[name][:] = handle
    columns["interpolation"][:] = interpolation
    return KeyTable(keys, columns)


def values_at(curve: bpy.types.FCurve, frames, kept: Collection[str] = ()) -> np.ndarray:
    """What the curve's keys come to at N frames: without its modifiers, but for the `kept` kinds.

    Keys are written from these values, and modifiers play over keys: in both they would count
    twice.
    """
    with _without_modifiers(curve, kept):
        return np.array([curve.evaluate(frame) for frame in frames], dtype=np.float64)


@contextmanager
def _without_modifiers(curve: bpy.types.FCurve, kept: Collection[str]) -> Iterator[None]:
    muted = [one for one in curve.modifiers if not one.mute and one.type not in kept]
    try:
        for modifier in muted:
            modifier.mute = True
        yield
    finally:
        for modifier in muted:
            modifier.mute = False
