# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of a face's curves: each is one pass over the chosen curves, keys as arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
import numpy as np

from .. import native
from . import actions, key_table
from .face_curves import Chosen, FaceCurve, has_keys, has_samples, head_curves
from .key_table import KeyTable


def smooth(chosen: Sequence[Chosen], frames: float) -> float | None:
    """Takes off what changes faster than a width in scene frames; returns the farthest that a key
    has moved, of a full activation: contact and detail, which have none, are not told, and None
    where there is nothing else. Keys stay where they are in time."""
    parts, moves = native.curve_keys(), []
    for one in chosen:
        table = key_table.read(one.of.curve)
        at = parts.sample_frames(table.keys.points[:, 0])
        values = key_table.values_at(one.of.curve, at)
        keys = table.keys.smoothed(at, values, frames, one.is_chosen)
        if not one.of.is_rest:
            move = np.abs(keys.points[:, 1] - table.keys.points[:, 1]).max()
            moves.append(float(move) / abs(one.of.unit))
        is_curved = one.is_chosen & (table.columns["interpolation"] == actions.BEZIER)
        for name in ("handle_left_type", "handle_right_type"):
            table.columns[name][is_curved] = actions.ALIGNED
        key_table.write(one.of.curve, table.with_keys(keys))
    return max(moves, default=None)


def exaggerate(chosen: Sequence[Chosen], factor: float, at: float | None, has_limits: bool) -> int:
    """Values times `factor` about rest, or about what each curve is at a scene frame; returns how
    many keys were kept within what their shape can do."""
    native.curve_keys().check_factor(factor)

    def larger(row: FaceCurve) -> tuple[float, float]:
        if at is None:
            return factor, 0.0
        (centre,) = key_table.values_at(row.curve, [at], key_table.IN_TIME)
        return factor, centre * (1 - factor)

    return _affine(chosen, larger, has_limits)


def shift(chosen: Sequence[Chosen], amount: float, has_limits: bool) -> int:
    """Values plus an amount, of which 1 is a full activation; returns as `exaggerate`."""
    return _affine(chosen, lambda row: (1.0, amount * row.unit), has_limits)


def set_neutral(chosen: Sequence[Chosen], at: float, has_limits: bool) -> int:
    """Values less what each curve plays at a scene frame; returns as `exaggerate`."""

    def resting(row: FaceCurve) -> tuple[float, float]:
        (keys,) = key_table.values_at(row.curve, [at], key_table.IN_TIME)
        under_modifiers = keys - row.curve.evaluate(at)  # where these bring the curve to rest
        if has_limits:  # or those that it is beyond would move it again each time
            under_modifiers = np.clip(under_modifiers, *row.limits)
        return 1.0, under_modifiers - keys

    return _affine(chosen, resting, has_limits)


def _affine(
    chosen: Sequence[Chosen], change: Callable[[FaceCurve], tuple], has_limits: bool
) -> int:
    beyond = 0
    for one in chosen:
        table = key_table.read(one.of.curve)
        keys = table.keys.affine(*change(one.of), one.is_chosen)
        if has_limits:
            keys, count = keys.limited(*one.of.limits, one.is_chosen)
            beyond += count
        key_table.write(one.of.curve, table.with_keys(keys))
    return beyond


def span(chosen: Sequence[Chosen]) -> tuple[float, float]:
    """Scene frames of the first and the last chosen key."""
    frames = [key_table.read(one.of.curve).keys.points[one.is_chosen, 0] for one in chosen]
    return min(float(f[0]) for f in frames), max(float(f[-1]) for f in frames)


def retime(
    curves: Sequence[bpy.types.FCurve], first: float, last: float, factor: float, later: float
) -> None:
    """What lies between two scene frames takes `factor` times as long; all after it moves along,
    and everything `later` frames."""
    for curve in curves:
        table = key_table.read(curve)
        key_table.write(curve, table.with_keys(table.keys.retimed(first, last, factor, later)))


def retimed_frames(
    frames: Sequence[float], first: float, last: float, factor: float, later: float
) -> list[float]:
    """Where `retime` moves what lies at scene frames."""
    points = np.column_stack([frames, np.zeros(len(frames))])
    keys = native.curve_keys().CurveKeys(points, points, points)
    return keys.retimed(first, last, factor, later).points[:, 0].tolist()


def ends(curves: Sequence[bpy.types.FCurve]) -> tuple[float, float]:
    """Scene frames of the first and the last key of curves."""
    ranges = [curve.range() for curve in curves]
    return float(min(first for first, _ in ranges)), float(max(last for _, last in ranges))


def curves_to_retime(
    face: bpy.types.Object, chosen: Sequence[Chosen], with_head: bool
) -> list[bpy.types.FCurve]:
    """The chosen ones, and the head's that are not locked and have keys."""
    head = head_curves(face) if with_head else []
    head = [curve for curve in head if not curve.lock and has_keys(curve)]
    return [*(one.of.curve for one in chosen), *head]


def mirror(chosen: Sequence[Chosen], curves: Sequence[FaceCurve], how: str, share: float) -> int:
    """Gives curves what their counterparts of the other side do, by a share from 0 to 1; returns
    how many have changed.

    curves: all of the face. how: SWAP, each side the other's; LEFT, the left's on both; RIGHT;
    BOTH, the mean of the two. What lies in the middle is turned by SWAP, half by BOTH. What turns
    the eyes, which look one way together, is changed by SWAP alone. Where a side has no keys both
    are left alone.
    """
    twin_of, share_of = native.curve_keys().twin_of, native.curve_settings().mirrored_share
    by_shape = {row.shape: row for row in curves}
    names = {one.of.shape for one in chosen}
    names |= {twin_of(name)[0] for name in names}
    changes = []
    for name in sorted(names & set(by_shape)):
        twin_name, sign = twin_of(name)
        row, twin = by_shape[name], by_shape.get(twin_name)
        if twin is None or row.curve.lock:
            continue
        if not (has_keys(row.curve) and has_keys(twin.curve)):
            continue
        weight = share * share_of(name, how.lower())
        if weight:
            factor = sign * row.unit / twin.unit
            changes.append((row, _mixed(row, twin, weight, factor)))
    for row, table in changes:  # only now: all were read before any was written
        key_table.write(row.curve, table)
    return len(changes)


def sampled_twins(chosen: Sequence[Chosen], curves: Sequence[FaceCurve]) -> list[str]:
    """Shapes that `mirror` leaves alone, with the chosen ones, as they have samples."""
    twins = {native.curve_keys().twin_of(one.of.shape)[0] for one in chosen}
    return [row.shape for row in curves if row.shape in twins and has_samples(row.curve)]


def _mixed(row: FaceCurve, twin: FaceCurve, share: float, factor: float) -> KeyTable:
    own, other = key_table.read(row.curve), key_table.read(twin.curve)
    if share == 1:
        return other.with_keys(other.keys.affine(factor, 0.0))
    parts = native.curve_keys()
    frames = np.unique(np.concatenate([own.keys.points[:, 0], other.keys.points[:, 0]]))
    at = parts.slope_frames(frames)
    samples = [parts.samples(key_table.values_at(one.curve, at)) for one in (row, twin)]
    keys = parts.mixed(frames, list(zip((1 - share, factor * share), samples, strict=True)))
    is_straight = all(table.is_of("interpolation", actions.LINEAR) for table in (own, other))
    kind = actions.LINEAR if is_straight else actions.BEZIER
    return key_table.as_cubics(own, keys, actions.FREE, kind)
