# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves that a bake put on a character's own controls or its muscles, known again by the next.

That bake goes on from a copy of the action, and takes back what it drives no longer: a control
that was switched off since, or all muscles where own controls play instead, are at rest, unless
someone has keyed or edited the curve by hand.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Collection

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat
from . import key_table, rest_pose

NOTED = "mimetic_baked_curves"  # of an action: by path and index, the sum of a curve's keys


def replace(id_block: bpy.types.ID, keyed: Collection[tuple[str, int]]) -> int:
    """Removes curves of a bake before that are as it left them, but for those that this bake keyed
    (path and index of each), puts what they moved to rest, and keeps which are a bake's now.
    Returns how many it removed. What was renamed since is known by its curve's keys."""
    action, holder = id_block.animation_data.action, compat.curves(id_block)
    noted, sums = json.loads(action.get(NOTED, "{}")), {}
    num_removed = 0
    names = {_name(curve) for curve in holder.fcurves}
    left = {(_unnamed(name), total) for name, total in noted.items() if name not in names}
    for curve in list(holder.fcurves):
        path, index = curve.data_path, curve.array_index
        if (path, index) in keyed:
            sums[_name(curve)] = _sum_of(curve)
        elif _sum_of(curve) == noted.get(_name(curve)) or (
            _name(curve) not in noted and (_unnamed(_name(curve)), _sum_of(curve)) in left
        ):
            holder.fcurves.remove(curve)
            rest_pose.put_to_rest(id_block, path, index)
            num_removed += 1
    action[NOTED] = json.dumps(sums)
    return num_removed


def play(id_block: bpy.types.ID) -> bool:
    """Whether its action has curves of a bake, so that `replace` has to do with it."""
    animation = id_block.animation_data
    action = animation.action if animation is not None else None
    return action is not None and action.get(NOTED, "{}") != "{}"


def at_rest(num_removed: int, name: str) -> str:
    """What to say of sliders of an object's that `replace` put to rest, or nothing."""
    if not num_removed:
        return ""
    if num_removed == 1:
        return rpt_("1 slider of {name} that an earlier take moved is at rest now").format(
            name=name
        )
    return rpt_("{count} sliders of {name} that an earlier take moved are at rest now").format(
        count=num_removed, name=name
    )


def _name(curve: bpy.types.FCurve) -> str:
    return f"{curve.data_path} {curve.array_index}"


def _unnamed(name: str) -> str:
    """A curve's name without that of the bone or shape key that it moves."""
    return name.removeprefix(rest_pose.moved_by(name))


def _sum_of(curve: bpy.types.FCurve) -> int:
    return zlib.crc32(key_table.mark(curve))
