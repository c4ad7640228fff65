# SPDX-License-Identifier: GPL-3.0-or-later
"""The curves that move a face, on its shape keys or its control object, and which of them an edit
is meant for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, native
from . import by_hand, control_bones, control_object

SIDES = (".L", ".R")


@dataclass(frozen=True)
class FaceCurve:
    """A curve of one muscle, articulator or shape; its values are the shape's times `unit`."""

    curve: bpy.types.FCurve
    shape: str
    group: str
    unit: float
    lowest: float  # what the shape can do
    highest: float

    @property
    def side(self) -> str:
        return self.shape[-2:] if self.shape.endswith(SIDES) else ""

    @property
    def is_rest(self) -> bool:
        """Of contact or detail, which no group has and whose values are no activations."""
        parts = native.shapes()
        return self.group in (parts.DETAIL, parts.CONTACT)

    @property
    def limits(self) -> tuple[float, float]:
        """Of the curve's own values."""
        low, high = self.lowest * self.unit, self.highest * self.unit
        return min(low, high), max(low, high)


@dataclass(frozen=True)
class Choice:
    """Which curves an edit is meant for."""

    on: str = "ALL"  # "CURVES", the selected ones; "KEYS", the selected keys of any
    group: str = ""  # its name; "" for all
    side: str = "BOTH"  # "LEFT", "RIGHT"
    with_rest: bool = False  # contact and detail too, which no group has


@dataclass(frozen=True)
class Chosen:
    """A curve, and which of its K keys."""

    of: FaceCurve
    is_chosen: np.ndarray


def of(face: bpy.types.Object) -> list[FaceCurve]:
    """All curves of a face, in the order of its sliders."""
    rows = _of_keys(face)
    if control_object.of(face) is not None:
        rows += _of_controls(face)
    return rows


def are_in_strips(face: bpy.types.Object) -> bool:
    """Whether strips of the NLA play the face, whose curves are reached where one is open (Tab)."""
    blocks = face.data.shape_keys, control_object.of(face)
    animations = [block.animation_data for block in blocks if block is not None]
    tracks = [track for one in animations if one is not None for track in one.nla_tracks]
    return any(strip.action is not None for track in tracks for strip in track.strips)


def are_all(face: bpy.types.Object, curves: Iterable[bpy.types.FCurve]) -> bool:
    """Whether every curve of a face is among these."""
    given = {curve.as_pointer() for curve in curves}
    return all(row.curve.as_pointer() in given for row in of(face))


def head_curves(face: bpy.types.Object) -> list[bpy.types.FCurve]:
    """What moves the head: the object, or the control object's bone."""
    movers = [(face, "")]
    if (control := control_object.of(face)) is not None:
        movers.append((control, f'pose.bones["{native.control_object().HEAD}"].'))
    return [
        curve
        for mover, prefix in movers
        if (holder := compat.curves(mover)) is not None
        for curve in holder.fcurves
        if curve.data_path.startswith((f"{prefix}location", f"{prefix}rotation"))
    ]


def has_keys(curve: bpy.types.FCurve) -> bool:
    """Whether there is something to edit: samples (Keys to Samples) are none."""
    return len(curve.keyframe_points) > 0


def has_samples(curve: bpy.types.FCurve) -> bool:
    return len(curve.sampled_points) > 0 and not has_keys(curve)


def choose(face: bpy.types.Object, choice: Choice) -> list[Chosen]:
    """The curves that are meant; raises InvalidInput where there are none. Locked ones are not, nor
    those without keys."""
    curves = of(face)
    groups = list(dict.fromkeys(row.group for row in curves if not row.is_rest))
    if choice.group and choice.group not in groups:
        raise native.invalid_input(
            rpt_("{face} has no curves of a group {group}: it has {groups}").format(
                face=face.name, group=choice.group, groups=", ".join(groups)
            )
        )
    pairs = [(row, _flags(row.curve, choice.on)) for row in _meant(curves, choice)]
    chosen = [Chosen(row, flags) for row, flags in pairs if flags.any()]
    if not chosen:
        if names := sampled(face, choice):
            raise native.invalid_input(sampled_text(names))
        text = {
            "CURVES": rpt_("{face}: no curve{where} is selected (Graph Editor) that is not locked"),
            "KEYS": rpt_("{face}: no key{where} is selected (Graph Editor) that is not locked"),
        }.get(choice.on, rpt_("{face}: no curve{where} that is not locked"))
        where = rpt_(" of {group}").format(group=choice.group) if choice.group else ""
        raise native.invalid_input(text.format(face=face.name, where=where))
    return chosen


def sampled(face: bpy.types.Object, choice: Choice) -> list[str]:
    """Shapes whose curves are meant, but have samples instead of keys."""
    if choice.on == "KEYS":
        return []
    rows = [row for row in _meant(of(face), choice) if has_samples(row.curve)]
    return [row.shape for row in rows if choice.on == "ALL" or row.curve.select]


def sampled_text(names: list[str]) -> str:
    """Why curves of these shapes are left alone."""
    text = rpt_("{names}: samples instead of keys (Graph Editor, Channel > Samples to Keys)")
    return text.format(names=by_hand.told(names))


def _meant(curves: list[FaceCurve], choice: Choice) -> Iterator[FaceCurve]:
    """Those of the group and the side that are not locked."""
    side = {"LEFT": ".L", "RIGHT": ".R"}.get(choice.side, "")
    for row in curves:
        is_of_group = row.group == choice.group if choice.group else not row.is_rest
        is_meant_too = row.is_rest and choice.with_rest and not choice.group
        if (is_of_group or is_meant_too) and side in ("", row.side) and not row.curve.lock:
            yield row


def _flags(curve: bpy.types.FCurve, on: str) -> np.ndarray:
    flags = np.ones(len(curve.keyframe_points), dtype=np.bool_)
    if on == "KEYS":
        curve.keyframe_points.foreach_get("select_control_point", flags)
    elif on == "CURVES" and not curve.select:
        flags[:] = False
    return flags


def _of_keys(face: bpy.types.Object) -> list[FaceCurve]:
    keys = face.data.shape_keys
    holder = compat.curves(keys) if keys else None
    if holder is None:
        return []
    by_path = {curve.data_path: curve for curve in holder.fcurves}
    names, rows = by_hand.keys_now(face), []
    for shape, entry in by_hand.entries_of(face).items():
        key = keys.key_blocks.get(names.get(shape, ""))
        curve = by_path.get(key.path_from_id("value")) if key else None
        if curve is not None:
            limits = key.slider_min, key.slider_max
            rows.append(FaceCurve(curve, shape, entry.group, 1.0, *limits))
    return rows


def _of_controls(face: bpy.types.Object) -> list[FaceCurve]:
    holder = compat.curves(control_object.of(face))
    if holder is None:
        return []
    parts = native.control_object()
    by_path = {(curve.data_path, curve.array_index): curve for curve in holder.fcurves}
    channels, _ = control_object.channels_of(face)
    rows = []
    for channel in channels:
        curve = by_path.get((control_bones.path_of(channel), channel.index))
        if curve is not None:
            limits = channel.lowest, channel.highest
            rows.append(FaceCurve(curve, channel.shape, channel.group, channel.unit, *limits))
    for bone, axis, shape in parts.gaze_channels():
        if curve := by_path.get((f'pose.bones["{bone}"].location', axis)):
            rows.append(
                FaceCurve(curve, shape, parts.GAZE_GROUP, parts.GAZE_DISTANCE, -np.inf, np.inf)
            )
    return rows
