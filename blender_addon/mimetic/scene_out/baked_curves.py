# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that a bake put on a character's own controls, known again by the next bake.

That bake goes on from a copy of the action, and takes back what it drives no longer: a control
that was switched off since is at rest, unless someone has keyed or edited its curve by hand.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Collection

import bpy

from .. import compat
from . import key_table, rest_pose

NOTED = "mimetic_baked_curves"  # of an action: by path and index, the sum of a curve's keys


def replace(id_block: bpy.types.ID, keyed: Collection[tuple[str, int]]) -> None:
    """Removes curves of a bake before that are as it left them, but for those that this bake keyed
    (path and index of each), puts what they moved to rest, and keeps which are a bake's now."""
    action, holder = id_block.animation_data.action, compat.curves(id_block)
    noted, sums = json.loads(action.get(NOTED, "{}")), {}
    for curve in list(holder.fcurves):
        path, index = curve.data_path, curve.array_index
        if (path, index) in keyed:
            sums[_name(curve)] = _sum_of(curve)
        elif noted.get(_name(curve)) == _sum_of(curve):
            holder.fcurves.remove(curve)
            rest_pose.put_to_rest(id_block, path, index)
    action[NOTED] = json.dumps(sums)


def _name(curve: bpy.types.FCurve) -> str:
    return f"{curve.data_path} {curve.array_index}"


def _sum_of(curve: bpy.types.FCurve) -> int:
    return zlib.crc32(key_table.mark(curve))
