# SPDX-License-Identifier: GPL-3.0-or-later
"""The control object of a face: bones that drive its shapes, so that animators' tools work on them.

A bone a muscle, a lid, a part of the lips, with one property each; the jaw and the target of the
gaze by where their bones are. Lengths in metres in the character frame: x to the subject's left, y
backwards, z up, from midway between the ears.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.gaze_shapes import GAZE_GROUP, LOOKS, TURNS, gaze_sliders
from mimetic.character.shapes import (
    ACTION_UNITS,
    CONTACT,
    DETAIL,
    GROUPS,
    SIDES,
    shapes_of,
)
from mimetic.muscles.anatomy import muscle_table
from mimetic.muscles.articulators import JAW
from mimetic.muscles.extras import gaze_rows
from mimetic.performance.document import Performance
from mimetic.performance.gaze import gaze_of, has_gaze

HEAD, JAW_BONE, GAZE_BONE = "head", "jaw", "gaze"
LOCATION = "location"
ACTIVATION, STRENGTH, VALUE = "activation", "strength", "value"  # properties of bones
# How far the jaw's bone is drawn for a value of 1: to the subject's left, forwards, down
JAW_TRAVEL = {"jaw_side": (0, 0.03), "jaw_thrust": (1, -0.03), "jaw_open": (2, -0.03)}
GAZE_DISTANCE = 0.5
LIFT = 0.02  # of a bone off the skin
APART = 0.006  # of bones seen from the front: muscles of a mouth's corner have nearly one middle
COLUMN = 0.115  # of the groups' bones from the middle of the face
COLUMN_STEP = 0.02
NOT_BY_BONES = (DETAIL, CONTACT, ACTION_UNITS, GAZE_GROUP)


@dataclass(frozen=True)
class Slider:
    """A slider of a face, as its object remembers it."""

    shape: str
    group: str  # what it is listed under
    lowest: float
    highest: float


@dataclass(frozen=True)
class Channel:
    """One number of a bone, and the slider that it drives: number = value times unit."""

    shape: str
    group: str
    bone: str
    path: str  # LOCATION, or the name of the bone's own property
    index: int  # of a location's axis
    unit: float
    lowest: float  # of the slider
    highest: float
    tip: str

    @property
    def expression(self) -> str:
        """What a driver computes of `control`, the number; empty for the number itself."""
        return "" if self.unit == 1 else f"control*{1 / self.unit:.9g}"


def channels_of(sliders: Sequence[Slider], groups: Sequence[Slider]) -> list[Channel]:
    """Numbers that drive a face's sliders and those of its groups; the gaze is apart."""
    units = {row["name"]: row["units"] for row in muscle_table()}
    return [
        *(_channel(s, units) for s in sliders if s.group not in NOT_BY_BONES),
        *(
            Channel(
                *(s.shape, s.group, s.shape, STRENGTH, 0, 1.0, s.lowest, s.highest),
                f"All muscles of {_words(s.shape)}, on top of their own",
            )
            for s in groups
        ),
    ]


def _channel(slider: Slider, units: Mapping[str, Sequence[int]]) -> Channel:
    stem = slider.shape.removesuffix(".L").removesuffix(".R")
    limits = slider.lowest, slider.highest
    if slider.shape in JAW_TRAVEL:
        index, unit = JAW_TRAVEL[slider.shape]
        tip = _words(slider.shape)
        return Channel(slider.shape, slider.group, JAW_BONE, LOCATION, index, unit, *limits, tip)
    path = ACTIVATION if slider.group in GROUPS.values() else VALUE
    numbers = ", ".join(str(unit) for unit in units.get(stem, ()))
    tip = _words(slider.shape) + (f"; action unit {numbers}" if numbers else "")
    return Channel(slider.shape, slider.group, slider.shape, path, 0, 1.0, *limits, tip)


def _words(name: str) -> str:
    stem = name.removesuffix(".L").removesuffix(".R")
    side = {".L": ", the subject's left", ".R": ", the subject's right"}.get(name[len(stem) :], "")
    return stem.replace("_", " ").capitalize() + side


def parents_of(channels: Sequence[Channel]) -> dict[str, str]:
    """The parent of each bone: groups above their sides, sides above their muscles."""
    bones = {channel.bone for channel in channels}
    parents = {}
    for channel in channels:
        side = next((s for s in SIDES[1:] if channel.bone.endswith(s)), "")
        above = [channel.group + side, channel.group]
        known = [name for name in above if name in bones and name != channel.bone]
        if channel.bone == channel.group:
            known = []
        parents[channel.bone] = known[0] if known else HEAD
    return parents


def places_of(
    channels: Sequence[Channel], points: NDArray[np.float64], fields: Mapping[str, NDArray]
) -> dict[str, NDArray[np.float64]]:
    """Where each bone stands: before the skin that it moves, as far apart that each can be picked;
    groups in columns beside the face.

    points: V x 3, the face at rest; fields: V x 3 displacements of each shape at value 1.
    """
    groups = {channel.bone for channel in channels if channel.path == STRENGTH}
    places: dict[str, list] = {}
    for channel in channels:
        if channel.bone not in groups:
            centre = centre_of(points, fields[channel.shape])
            places.setdefault(channel.bone, []).append(centre)
    lift = np.array([0.0, -LIFT, 0.0])
    means = {bone: np.mean(several, axis=0) + lift for bone, several in places.items()}
    apart = _core.drawn_apart(np.array(list(means.values())).reshape(-1, 3), APART)
    return dict(zip(means, apart, strict=True)) | _columns(channels, means)


def centre_of(points: NDArray[np.float64], field: NDArray) -> NDArray[np.float64]:
    """The middle (3) of what a shape moves."""
    return _core.centre_of_motion(
        np.ascontiguousarray(points, dtype=np.float64),
        np.ascontiguousarray(field, dtype=np.float64),
    )


def _columns(channels: Sequence[Channel], places: Mapping) -> dict[str, NDArray[np.float64]]:
    """Groups from the forehead down: of the left and the right at their sides, of both outside."""
    columns: dict[str, NDArray[np.float64]] = {}
    for side, x in zip(SIDES, (COLUMN + 2 * COLUMN_STEP, COLUMN, -COLUMN), strict=True):
        names = [c.bone for c in channels if c.path == STRENGTH and c.bone == c.group + side]
        heights = {
            name: np.mean([places[c.bone][2] for c in members])
            for name in names
            if (members := [c for c in channels if c.bone in places and c.group + side == name])
        }
        names = sorted(names, key=lambda name: -heights.get(name, 0.0))
        top = np.mean(list(heights.values()) or [0.0]) + COLUMN_STEP * (len(names) - 1) / 2
        for row, name in enumerate(names):
            columns[name] = np.array([x, -0.05, top - COLUMN_STEP * row])
    return columns


def gaze_expressions(kind: str, side: str) -> dict[str, str]:
    """What drivers compute of `yaw` and `pitch` (radians, to the subject's left and up) of an eye.

    Blender evaluates them without running scripts.
    """
    if kind == "turns":
        left, share = "sin(yaw)*cos(pitch)", "(1+cos(yaw)*cos(pitch))"
        of_shape = {
            "eye_down": "-sin(pitch)",
            "eye_left": left,
            "eye_down_down": f"sin(pitch)*sin(pitch)/{share}",
            "eye_down_left": f"-sin(pitch)*{left}/{share}",
            "eye_left_left": f"{left}*{left}/{share}",
        }
    elif kind == "looks":
        degrees = {row["name"]: float(row["degrees"]) for row in gaze_rows()}
        outwards = "yaw" if side == "L" else "-yaw"
        inwards = "-yaw" if side == "L" else "yaw"
        ways = dict(zip(LOOKS, ("pitch", "-pitch", inwards, outwards), strict=True))
        of_shape = {look: f"max(degrees({way})/{degrees[look]:g},0)" for look, way in ways.items()}
    else:
        return {}
    return {f"{name}.{side}": expression for name, expression in of_shape.items()}


def lid_expression(per_degree: float, rest_pitch: float) -> str:
    """An upper lid that goes along with its eye, of its own `control` and the eye's `pitch`.

    It is `_core.LidFollowing.seen`.
    """
    lid = _core.LidFollowing
    carried = f"{per_degree:.9g}*({rest_pitch:.9g}-degrees(pitch))"
    carried = f"min(max({carried},{lid.LOWEST_CARRIED:g}),{lid.HIGHEST_CARRIED:g})"
    return f"control+{carried}*(1-control)"


def channel_values(performance: Performance, kind: str) -> dict[str, NDArray[np.float64]]:
    """N values a slider that bones drive; lids by themselves where eyes carry them (`kind`)."""
    shapes = shapes_of(performance.without_detail())
    if kind == "looks":
        shapes = gaze_sliders(performance, shapes)
    values = {shape.name: shape.values for shape in shapes if shape.group not in NOT_BY_BONES}
    if kind == "turns" and has_gaze(performance):
        own = dict(zip(performance.articulators, performance.articulator_values.T, strict=True))
        values |= {name: own[name] for name in ("lid_upper.L", "lid_upper.R") if name in own}
    return values


def gaze_locations(performance: Performance) -> dict[str, NDArray[np.float64]]:
    """N x 3 locations of the gaze's bone, and of each eye's from it, at GAZE_DISTANCE."""
    if not has_gaze(performance):
        return {}
    angles = np.ascontiguousarray(gaze_of(performance))
    eyes = []
    for eye in range(2):
        yaw, pitch = angles[:, 2 * eye].copy(), angles[:, 2 * eye + 1].copy()
        left, up = _core.gaze_offsets(yaw, pitch, GAZE_DISTANCE).T
        eyes.append(np.column_stack([left, np.zeros(len(left)), up]))
    both = 0.5 * (eyes[0] + eyes[1])
    return {GAZE_BONE: both, f"{GAZE_BONE}.L": eyes[0] - both, f"{GAZE_BONE}.R": eyes[1] - both}


def gaze_channels() -> list[tuple[str, int, str]]:
    """Bone, axis of its location, and what the mirror calls it (`mimetic.muscles.sides`)."""
    bones = (GAZE_BONE, f"{GAZE_BONE}.L", f"{GAZE_BONE}.R")
    return [
        (bone, axis, f"{stem}{bone.removeprefix(GAZE_BONE)}")
        for bone in bones
        for axis, stem in ((0, "gaze_yaw"), (1, "gaze_depth"), (2, "gaze_pitch"))
    ]


def eye_centres(
    kind: str, points: NDArray[np.float64], fields: Mapping[str, NDArray]
) -> dict[str, NDArray[np.float64]]:
    """Where each eye's bone stands, by side: the middle of what turns it."""
    stem = {"turns": TURNS[1], "looks": LOOKS[3]}.get(kind)
    if stem is None:
        return {}
    return {side: centre_of(points, fields[f"{stem}.{side}"]) for side in "LR"}


def covered(channels: Sequence[Channel], kind: str) -> set[str]:
    """The shapes that bones drive."""
    names = {channel.shape for channel in channels}
    return names | {name for side in "LR" for name in gaze_expressions(kind, side)}


assert set(JAW_TRAVEL) == set(JAW)
