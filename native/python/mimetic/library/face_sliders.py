# SPDX-License-Identifier: GPL-3.0-or-later
"""What a face's sliders do, as channels of an expression, and the other way round.

Faces turn their eyes by shapes of their own kind, an expression by a gaze in degrees. The sliders
of upper lids are what is seen of them where the shapes of a captured face turn its eyes; an
expression has what they do by themselves. Both count from the face at rest, where all is 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.character.gaze_shapes import (
    LOOKS,
    TURNS,
    angles_of_keys,
    angles_of_looks,
    gaze_kind,
    look_values,
    turn_weights,
)
from mimetic.library.expression import limits_of
from mimetic.performance.gaze import GAZE, SIDES

Floats = NDArray[np.float64]


def with_gaze(
    names: Sequence[str], values: Floats, lids_per_degree: Sequence[float]
) -> tuple[list[str], Floats]:
    """Sliders' values (N x S) with the eyes' in degrees, as channels of an expression.

    lids_per_degree: 2, closure of each upper lid for a degree that its eye looks down.
    """
    columns = dict(zip(names, np.asarray(values, dtype=np.float64).T, strict=True))
    kind = gaze_kind(columns)
    if not kind:
        return list(columns), np.array(list(columns.values())).T
    for side, per_degree in zip(SIDES, lids_per_degree, strict=True):
        stems = TURNS if kind == "turns" else LOOKS
        eye = {name: columns.pop(name) for name in (f"{stem}.{side}" for stem in stems)}
        if kind == "turns":
            rows = (dict(zip(eye, row, strict=True)) for row in zip(*eye.values(), strict=True))
            yaw, pitch = np.degrees([angles_of_keys(side, row) for row in rows]).T
        else:
            yaw, pitch = angles_of_looks(side, eye)
        if (lid := f"lid_upper.{side}") in columns:
            seen = columns[lid] - (per_degree * pitch if kind == "looks" else 0.0)
            columns[lid] = _core.LidFollowing(per_degree, 0.0).own(seen, pitch)
        columns |= {f"gaze_yaw.{side}": yaw, f"gaze_pitch.{side}": pitch}
    return list(columns), np.array(list(columns.values())).T


def without_gaze(
    channels: Sequence[str],
    values: Floats,
    sliders: Iterable[str],
    lids_per_degree: Sequence[float],
) -> tuple[list[str], Floats]:
    """Channels' values (N x C) with the eyes' as a face turns them that has these sliders.

    Where nothing of the face turns its eyes, the gaze stays as it is. lids_per_degree: as of
    `with_gaze`.
    """
    columns = dict(zip(channels, np.asarray(values, dtype=np.float64).T, strict=True))
    kind = gaze_kind(sliders)
    if not kind or not any(name in columns for name in GAZE):
        return list(columns), np.array(list(columns.values())).T
    ahead = np.zeros(len(values))
    for side, per_degree in zip(SIDES, lids_per_degree, strict=True):
        yaw, pitch = (columns.pop(f"gaze_{axis}.{side}", ahead) for axis in ("yaw", "pitch"))
        lid = f"lid_upper.{side}"
        shown = _core.LidFollowing(per_degree, 0.0).seen(columns.get(lid, ahead), pitch)
        if kind == "turns":
            names = (f"{stem}.{side}" for stem in TURNS)
            columns |= dict(zip(names, turn_weights(yaw, pitch).T, strict=True))
        else:  # sliders that look up and down carry the lids themselves
            shown = shown + per_degree * pitch
            columns |= look_values(side, yaw, pitch)
        if lid in columns or shown.any():
            columns[lid] = shown
    return list(columns), np.array(list(columns.values())).T


def with_groups(
    names: Sequence[str], values: Floats, members: Mapping[str, Sequence[str]]
) -> tuple[list[str], Floats]:
    """Sliders' values (N x S) with what the sliders of groups do, as their muscles' own.

    members: muscles of each group's slider, by its name.
    """
    columns = dict(zip(names, np.array(values, dtype=np.float64).T, strict=True))
    for group, muscles in members.items():
        added = columns.pop(group, None)
        for muscle in muscles:
            if added is not None and muscle in columns:
                columns[muscle] = columns[muscle] + added
    return list(columns), np.array(list(columns.values())).T


def limits_on(channels: Sequence[str], sliders: Mapping[str, tuple[float, float]]) -> Floats:
    """Least and greatest values, 2 x C, as the sliders reach; without one, as in the tables."""
    usual = limits_of(list(channels), []).T
    return np.array([sliders.get(n, own) for n, own in zip(channels, usual, strict=True)]).T
