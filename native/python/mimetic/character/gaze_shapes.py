# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyes that turn, as shapes: linear ones whose sum is a rigid turn, and sliders of heads.

A shape key or morph target cannot rotate; five of them an eye can, as a turn is linear in the
sine of its angle and its products. So eyes turn in every engine that knows morph targets, in the
face's own mesh, without nodes or bones that an exchange may lose.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mimetic import _core
from mimetic.character.shape import Shape, shape_of_values
from mimetic.muscles.extras import gaze_rows
from mimetic.performance.document import Performance
from mimetic.performance.gaze import SIDES, gaze_of, has_gaze, seen_articulators

GAZE_GROUP = "Gaze"
# Of `_core.eye_turn_modes`: sines of the turn down and to the left, then their products
TURNS = ("eye_down", "eye_left", "eye_down_down", "eye_down_left", "eye_left_left")
# Sliders of the anatomy's extras, which heads have
LOOKS = ("look_up", "look_down", "look_in", "look_out")


def gaze_kind(names: Iterable[str]) -> str:
    """What turns a face's eyes: "turns" (the shapes TURNS), "looks" (LOOKS), or "" for nothing."""
    known = set(names)
    for kind, stems in (("turns", TURNS), ("looks", LOOKS)):
        if known.issuperset(f"{stem}.{side}" for stem in stems for side in "LR"):
            return kind
    return ""


def gaze_shapes(performance: Performance) -> list[Shape]:
    """Five shapes an eye, whose values turn it rigidly; none where the performance has no gaze."""
    if not has_gaze(performance):
        return []
    shapes = []
    angles, centers = gaze_of(performance), np.asarray(performance.eye_centers)
    for eye, side in enumerate(SIDES):
        on_eye = np.asarray(performance.eye_of_vertex) == eye + 1
        offsets = np.zeros((len(TURNS), *performance.neutral_vertices.shape))
        offsets[:, on_eye] = _core.eye_turn_modes(
            performance.neutral_vertices[on_eye], centers[eye]
        )
        weights = turn_weights(angles[:, 2 * eye], angles[:, 2 * eye + 1])
        shapes += [
            shape_of_values(f"{name}.{side}", GAZE_GROUP, mode, values, -1.0)
            for name, mode, values in zip(TURNS, offsets, weights.T, strict=True)
        ]
    return shapes


def turn_weights(yaw: NDArray[np.float64], pitch: NDArray[np.float64]) -> NDArray[np.float64]:
    """N x TURNS: values of an eye's shapes; degrees, to the subject's left and up."""
    return _core.eye_turn_weights(np.ascontiguousarray(yaw), np.ascontiguousarray(pitch))


def eye_quaternions(
    yaw: NDArray[np.float64],
    pitch: NDArray[np.float64],
    object_from_character: ArrayLike | None = None,
) -> NDArray[np.float64]:
    """N x 4, w first: the turns that those shapes make; degrees. The shortest way from straight
    ahead, as eyes take it.

    object_from_character: 4 x 4, how a head lies in its object; None: it looks along -y, z up.
    """
    weights = turn_weights(yaw, pitch)
    down, left = weights[:, 0], weights[:, 1]
    ahead = np.cos(np.radians(yaw)) * np.cos(np.radians(pitch))
    half = np.sqrt(2 * (1 + ahead))  # twice the cosine of half of the turn
    turns = np.column_stack([half / 2, down / half, np.zeros_like(down), left / half])
    if object_from_character is not None:
        axes = _core.rotation_of(np.asarray(object_from_character, float)[:3, :3], "head")
        turns[:, 1:] = turns[:, 1:] @ axes.T
    return turns


def turned_keys(side: str, yaw: float, pitch: float) -> dict[str, float]:
    """The values of one eye's shapes by name; radians."""
    weights = turn_weights(np.degrees([yaw]), np.degrees([pitch]))[0]
    return {f"{name}.{side}": float(w) for name, w in zip(TURNS, weights, strict=True)}


def carried_lid(closure: float, following: Sequence[float], before: float, after: float) -> float:
    """The closure that is seen of an upper lid when its eye has turned from pitch to pitch.

    following: as a performance's `lid_following` has it; pitches in radians. What the lid does by
    itself stays.
    """
    lid = _core.LidFollowing(*following)
    own = lid.own(np.array([closure]), np.degrees([before]))
    return float(lid.seen(own, np.degrees([after]))[0])


def angles_of_keys(side: str, values: Mapping[str, float]) -> tuple[float, float]:
    """Yaw and pitch, radians, of one eye whose shapes have these values."""
    down, left = (np.clip(values.get(f"{name}.{side}", 0.0), -1, 1) for name in TURNS[:2])
    pitch = -np.arcsin(down)
    yaw = np.arcsin(np.clip(left / max(float(np.cos(pitch)), 1e-6), -1, 1))
    return float(yaw), float(pitch)


def gaze_sliders(performance: Performance, shapes: Sequence[Shape]) -> list[Shape]:
    """The shapes for a head whose sliders look up, down, in and out turn its eyes.

    Those that look up and down carry the lids in proportion, which is taken from the lids' values.
    """
    if not has_gaze(performance):
        return list(shapes)
    angles, articulator_values = gaze_of(performance), seen_articulators(performance)
    lids, looks = {}, []
    for eye, (side, following) in enumerate(
        zip(SIDES, np.asarray(performance.lid_following), strict=True)
    ):
        yaw, pitch = angles[:, 2 * eye], angles[:, 2 * eye + 1]
        name = f"lid_upper.{side}"
        if name in performance.articulators:
            lids[name] = (
                articulator_values[:, performance.articulators.index(name)] + following[0] * pitch
            )
        looks += [
            shape_of_values(look, GAZE_GROUP, np.zeros((0, 3)), values, 0.0)
            for look, values in look_values(side, yaw, pitch).items()
        ]
    own = [replace(s, values=lids[s.name]) if s.name in lids else s for s in shapes]
    return [*own, *looks]


def look_values(
    side: str, yaw: NDArray[np.float64], pitch: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """N values of the sliders by which a head's eye looks up, down, in and out; N degrees."""
    degrees = {row["name"]: float(row["degrees"]) for row in gaze_rows()}
    outwards = yaw if side == "L" else -yaw
    ways = {"look_up": pitch, "look_down": -pitch, "look_in": -outwards, "look_out": outwards}
    return {f"{look}.{side}": np.maximum(way, 0) / degrees[look] for look, way in ways.items()}


def angles_of_looks(
    side: str, values: Mapping[str, NDArray[np.float64]]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Yaw and pitch, N degrees each, of an eye whose sliders have these values: the inverse."""
    turned = {row["name"]: row["degrees"] * values[f"{row['name']}.{side}"] for row in gaze_rows()}
    outwards = turned["look_out"] - turned["look_in"]
    return outwards if side == "L" else -outwards, turned["look_up"] - turned["look_down"]
