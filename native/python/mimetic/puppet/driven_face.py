# SPDX-License-Identifier: GPL-3.0-or-later
"""What a live state is on a face in a scene: values of its sliders or of its maker's own controls,
and its object's motion."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.gaze_shapes import look_values, turned_keys
from mimetic.character.placement import WORLD_FROM_SCENE_CAMERA
from mimetic.character.rig_motion import Channels, Motion, carried_channels
from mimetic.performance.gaze import GAZE
from mimetic.puppet.channels import channel_of
from mimetic.puppet.live_face import LiveFace
from mimetic.puppet.live_filter import LiveState
from mimetic.puppet.live_units import live_units
from mimetic.retarget.control_names import known_names, unit_shares
from mimetic.retarget.controls import ControlRow, ControlSurface
from mimetic.retarget.name_shares import by_shares, shares_once
from mimetic.retarget.playing import READABLE, fit_of, moving, refuse_unknown, table_of
from mimetic.solve.gaze import SIDES

Floats = NDArray[np.float64]
EYE_TURN = "eye_down.L"  # one of the five shapes by which a baked face turns an eye rigidly


@dataclass(frozen=True)
class Stand:
    """Where a face's object is before a live head moves it.

    world_from_character: 4 x 4, where its head rests in the world; location: 3, rotation: 3 x 3,
    its own; units: of the world, per metre.
    """

    world_from_character: Floats
    location: Floats
    rotation: Floats
    rotation_mode: str
    units: float = 1.0


def slider_values(
    names: Sequence[str],
    values: Floats,
    lids: Sequence[_core.LidFollowing],
    sliders: Collection[str],
) -> dict[str, float]:
    """Of those of a face's `sliders` that a live state moves.

    names, values: of the state, as `live_names`; lids: how the upper ones go along with the eyes.
    """
    by_name = {name: float(value) for name, value in zip(names, values, strict=True)}
    angles = np.array([by_name.pop(name) for name in GAZE])
    for eye, side in enumerate(SIDES):
        lid, (yaw, pitch) = f"lid_upper.{side}", angles[2 * eye : 2 * eye + 2]
        by_name[lid] = float(lids[eye].seen(np.array([by_name[lid]]), np.array([pitch]))[0])
        if EYE_TURN in sliders:
            by_name |= turned_keys(side, float(np.radians(yaw)), float(np.radians(pitch)))
        else:  # sliders that look up and down carry the lids themselves
            by_name[lid] += float(lids[eye].per_degree * pitch)
            looks = look_values(side, np.array([yaw]), np.array([pitch]))
            by_name |= {name: float(value[0]) for name, value in looks.items()}
    return {name: value for name, value in by_name.items() if name in sliders}


def channel_of_slider(name: str) -> str:
    """The channel that a face's slider belongs to."""
    return channel_of("gaze_" if name.startswith(("eye_", "look_")) else name)


def head_motion(poses: Floats, rest: Floats, pivot: Floats | None = None) -> Motion:
    """The head's motion from `rest`, in 1 + N frames: the first is at rest, so that no turn jumps.

    poses: N x 4 x 4, rest: 4 x 4, camera from head; pivot: as of `rig_motion.motion`.
    """
    every = np.concatenate([rest[None], poses])
    world = _core.world_from_object(every, WORLD_FROM_SCENE_CAMERA)
    return Motion(*_core.motion_from_rest(world, 0, False, np.zeros(3) if pivot is None else pivot))


def head_channels(poses: Floats, rest: Floats, stand: Stand) -> Channels:
    """Curves of the face's object, moved from where it stands as the head moves from `rest`.

    poses: N x 4 x 4, rest: 4 x 4, camera from head.
    """
    axes = _core.nearest_rotations(stand.world_from_character[None, :3, :3])[0]
    pivot = (stand.location - stand.world_from_character[:3, 3]) @ axes / stand.units
    channels = carried_channels(
        head_motion(poses, rest, pivot),
        stand.location,
        stand.rotation,
        np.eye(4),
        axes,
        stand.rotation_mode,
        stand.units,
    )
    return after_rest(channels)


def after_rest(channels: Channels) -> Channels:
    """Without the first frame, that of `head_motion` at rest."""
    locations = None if channels.locations is None else channels.locations[1:]
    return Channels(channels.rotation_path, channels.rotations[1:], locations)


class DrivenControls:
    """As `mimetic.retarget.playing.play` drives them, but for a face that is followed live.

    surface, rows, options: as there. Raises InvalidInput if there is nothing to go by.
    """

    def __init__(
        self,
        surface: ControlSurface,
        rows: Sequence[ControlRow] | None = None,
        options: _core.ControlFitOptions | None = None,
    ) -> None:
        table = table_of(surface, rows)
        used = surface.without(name for name in surface.ranges if name not in table)
        self._gaze = used.gaze
        names = list(used.control_names)
        known, moves = known_names(names), moving(used)
        self._shares = shares_once(names, known, moves)
        is_named = unit_shares(names, known).any(axis=1)
        self._fit: _core.ControlFit | None = None
        is_matched = np.zeros(len(names), dtype=bool)
        self._only_named = is_named
        if len(used.source_names):
            self._fit = fit_of(used, options)
            is_matched = moves & (self._fit.readable > READABLE)
            self._only_named = is_named & ~moves
        elif not is_named.any():
            refuse_unknown(names)
        # Eyes that turn rigidly are no muscles' sliders: as for a bake, gaze is by its sliders
        self._sources = list(used.source_names)
        self._played = [name for name in self._sources if not name.startswith("eye_")]
        kept = np.flatnonzero(is_matched | self._only_named)
        self._kept = [(int(k), table[names[k]]) for k in kept]
        self._eyes = [table[name] for name in used.gaze.names] if used.gaze is not None else []
        self.names = [names[k] for k in kept] + [row.control for row in self._eyes]

    def values(self, names: Sequence[str], state: LiveState, face: LiveFace) -> dict[str, float]:
        """Each control's value in a state; names: of the state's values."""
        expected = self._expected(state)
        turned = self._turned(names, state)
        if self._fit is None:
            fitted = expected
        else:
            own = slider_values(names, state.values, face.lids, self._played) | turned
            row = np.array([own.get(name, 0.0) for name in self._sources])
            fitted = self._fit.frames(row[None], expected[None])[0]
        fitted[self._only_named] = expected[self._only_named]
        fits = {row.control: float(row.played(fitted[k : k + 1])[0]) for k, row in self._kept}
        return fits | turned

    def _turned(self, names: Sequence[str], state: LiveState) -> dict[str, float]:
        """Controls that turn the eyes."""
        if self._gaze is None or not self._eyes:
            return {}
        by_name = dict(zip(names, state.values, strict=True))
        angles = np.array([[by_name[name] for name in GAZE]])
        fitted = self._gaze.values(angles)
        return {
            row.control: float(row.played(np.ascontiguousarray(fitted[:, k]))[0])
            for k, row in enumerate(self._eyes)
        }

    def _expected(self, state: LiveState) -> Floats:
        """What the controls' names say, 0 of those that are unknown."""
        if not self._shares.any():
            return np.zeros(len(self._shares))
        return by_shares(live_units().weights(state.values[None]), self._shares)[0]
