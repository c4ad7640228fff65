# SPDX-License-Identifier: GPL-3.0-or-later
"""Bones that turn a character's eyes, by what its eyeballs do when they move."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy
import numpy as np

from .. import head_parts, native, world
from . import bound, by_hand, own_keys, rest_pose

STEP = 1.0  # of a channel's value, to both sides
SIDES = ("L", "R")
TURNING = ("look_in", "look_out", "eye_left")  # shapes that move an eyeball and nothing else
MOVES = 0.05  # of what such a shape moves farthest


class Eyeballs:
    """Those of a face with muscles, in its own mesh or in objects that were attached with it."""

    def __init__(self, face: bpy.types.Object) -> None:
        self._face = face
        parts = [head_parts.object_of(part) for part in head_parts.remembered(face)]
        names = by_hand.keys_now(face)
        self._own = [
            [
                (obj, vertices)
                for obj in (face, *filter(None, parts))
                if len(vertices := _moved(obj, names if obj == face else {}, side))
            ]
            for side in SIDES
        ]

    @property
    def sides(self) -> tuple[str, ...]:
        """Of eyes that there are."""
        return tuple(side for side, own in zip(SIDES, self._own, strict=True) if own)

    def vertices(self, side: str) -> np.ndarray:
        """Of one in the face's own mesh, by their numbers."""
        own = self._own[SIDES.index(side)]
        return next((rows for obj, rows in own if obj == self._face), np.zeros(0, dtype=int))

    def places(self) -> list[np.ndarray]:
        """P x 3 of each eye, as the rig has them now, in the face's frame."""
        places = [[np.zeros((0, 3))] for _ in SIDES]
        for found, own in zip(places, self._own, strict=True):
            for obj, rows in own:
                found.append(self._in_face(obj, rest_pose.evaluated(obj)[rows]))
        return [np.concatenate(found) for found in places]

    def _in_face(self, obj: bpy.types.Object, points: np.ndarray) -> np.ndarray:
        if obj == self._face:
            return points
        matrix = native.array(world.matrix(self._face).inverted() @ world.matrix(obj))
        return points @ matrix[:3, :3].T + matrix[:3, 3]


def measured(
    scene: bpy.types.Scene,
    face: bpy.types.Object,
    eyeballs: Eyeballs,
    own: Sequence,
    with_value: Callable,
):
    """A `mimetic.retarget.GazeControls` of those of the eyes' channels that turn one, and what they
    take along of the face's mesh (K x V x 3 at value 1) besides. The rig is at rest.

    with_value: a context in which a channel has a value.
    """
    package = native.controls().gaze_controls
    channels, carried = [], []
    for channel in own:
        ends = []
        for side in (-1, 1):
            with with_value(channel, side * STEP):
                ends.append((rest_pose.evaluated(face), eyeballs.places()))
        turns = np.zeros((len(SIDES), 3))
        for eye, side in enumerate(SIDES):
            if side in eyeballs.sides:
                turns[eye] = package.turn_between(*(places[eye] for _, places in ends))
        one = package.gaze_channel(channel, turns, STEP)
        if package.turns_eyes(one):
            channels.append(one)
            carried.append((ends[1][0] - ends[0][0]) / (2 * STEP))
    frame = native.array(bound.object_from_character(scene, face))
    num_vertices = len(face.data.vertices)
    stack = np.stack(carried) if carried else np.zeros((0, num_vertices, 3))
    for side in SIDES:
        stack[:, eyeballs.vertices(side)] = 0.0
    return package.GazeControls(channels, frame, eyeballs.sides), stack


def _moved(obj: bpy.types.Object, names: dict[str, str], side: str) -> np.ndarray:
    """Vertices that a shape moves which turns an eye."""
    keys = obj.data.shape_keys
    for shape in TURNING if keys is not None else ():
        name = names.get(f"{shape}.{side}", f"{shape}.{side}")
        if (key := keys.key_blocks.get(name)) is not None:
            lengths = np.linalg.norm(own_keys.offsets_of(obj, key), axis=1)
            return np.flatnonzero(lengths > MOVES * max(lengths.max(initial=0.0), 1e-9))
    return np.zeros(0, dtype=int)
