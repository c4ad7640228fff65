# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys of rotations and locations: one a frame, or few with handles, and how far those are off."""

from __future__ import annotations

import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, native
from . import actions

AXES = np.sqrt(3)  # a place that is off along three axes is so much farther off


class MotionKeys:
    """How bones and objects are keyed, and what became of it.

    tolerance: by how much few keys may miss, of which 1 is a centimetre or ten degrees, as of the
    controls that bones are; 0 for a key a frame. by_phases: keys of a location along one axis lie
    at the phases of events first.
    """

    def __init__(self, tolerance: float = 0.0, by_phases: bool = False) -> None:
        if tolerance:
            native.sparse_curves().check_tolerance(tolerance)
        self.tolerance, self.by_phases = tolerance, by_phases
        self.num_keys = self.num_dense = 0
        self.turn_error = self.shift_error = 0.0  # radians, metres

    def turn(self, holder, path: str, group: str, frames, rows) -> int:
        """Keys a rotation (N x C) by curves whose keys lie at the same frames; returns C."""
        if not self.tolerance:
            return actions.key_columns(holder, path, group, frames, rows)
        tolerance = self.tolerance * native.bone_channels().TURN
        kind = path.rsplit(".", 1)[-1]
        keys, error = native.sparse_curves().sparse_rotation(frames, rows, kind, tolerance)
        self.turn_error = max(self.turn_error, error)
        return self._fill(holder, path, group, frames, keys)

    def shift(self, holder, path: str, group: str, frames, rows, metres: float) -> int:
        """Keys a location (N x 3, units of so many metres) likewise."""
        if not self.tolerance:
            return actions.key_columns(holder, path, group, frames, rows)
        tolerance = self.tolerance * native.bone_channels().CENTIMETRE / AXES
        keys = native.sparse_curves().sparse_together(frames, rows, tolerance / metres)
        farthest = AXES * metres * max(one.error for one in keys)
        self.shift_error = max(self.shift_error, float(farthest))
        return self._fill(holder, path, group, frames, keys)

    def along(self, curve, frames, values, unit: float) -> None:
        """Keys one axis of a location: values (N) in centimetres, `unit` of a centimetre."""
        tolerance = self.tolerance / AXES
        error = actions.fill_values(curve, frames, values, tolerance, self.by_phases, unit)
        if self.tolerance:
            farthest = AXES * native.bone_channels().CENTIMETRE * error
            self.shift_error = max(self.shift_error, float(farthest))
            self._count(len(curve.keyframe_points), len(frames))

    def text(self) -> str:
        """What few keys came to; nothing of a key a frame."""
        if not self.tolerance:
            return ""
        return rpt_(
            "{few} keys instead of {dense}, within {degrees:.2g} degrees and {mm:.2g} mm"
        ).format(
            few=self.num_keys,
            dense=self.num_dense,
            degrees=float(np.degrees(self.turn_error)),
            mm=1e3 * self.shift_error,
        )

    def _fill(self, holder, path: str, group: str, frames, keys) -> int:
        for index, one in enumerate(keys):
            actions.fill_sparse(compat.new_curve(holder, path, index, group), one)
            self._count(len(one.points), len(frames))
        return len(keys)

    def _count(self, few: int, dense: int) -> None:
        self.num_keys += few
        self.num_dense += dense
