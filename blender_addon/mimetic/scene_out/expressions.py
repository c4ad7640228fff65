# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions as assets: an action of shape keys' values each, a still of one key or a motion.

Its curves have the names of muscles and articulators, not those that keys were given by hand on one
face, so that it serves every face. Frame 0 is the expression's first row.
"""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, native
from . import actions, by_hand, contact

KIND = "mimetic_expression"  # of an action: STILL or MOTION
RATE = "mimetic_rate"  # scene frames a second that its keys were laid at
ONSET, PEAK = "mimetic_onset", "mimetic_peak"  # frames
STILL, MOTION = "still", "motion"
KEY_TYPE = "KEY"


def is_expression(action: bpy.types.Action) -> bool:
    return KIND in action


def new_asset(name: str, expression, rate: float, picture=None) -> bpy.types.Action:
    """An action asset of a `mimetic.library.expression.Expression`; picture: H x W x 4, or None."""
    action = new_action(name, expression, rate, {})
    action.asset_mark()
    action.asset_data.description = description(expression)
    action.asset_data.tags.new(KIND.replace("_", " "), skip_if_exists=True)
    if picture is not None:
        preview = action.preview_ensure()
        preview.image_size = picture.shape[1::-1]
        levels = np.ascontiguousarray(picture[::-1], dtype=np.float32) / 255  # bottom row first
        preview.image_pixels_float.foreach_set(levels.reshape(-1))
    return action


def ensure_units(rate: float) -> None:
    """An asset of each of FACS's action units that the file has none of."""
    units = native.library("units")
    for name in units.unit_meanings():
        action = bpy.data.actions.get(name)
        if action is None or not is_expression(action):
            new_asset(name, units.unit_expression(name), rate, units.unit_picture(name))


def new_action(name: str, expression, rate: float, key_names: dict[str, str]) -> bpy.types.Action:
    """An action that no data has yet; key_names: of a face's shapes whose keys are called so."""
    action, holder = compat.free_action(name, KEY_TYPE)
    step = rate / expression.fps
    frames = step * np.arange(len(expression.values))
    for channel, values in zip(expression.channels, expression.values.T, strict=True):
        curve = compat.new_curve(holder, _path(key_names.get(channel, channel)), 0, "Expression")
        actions.fill(curve, frames, values, actions.LINEAR)
    action[KIND] = STILL if expression.is_still else MOTION
    action[RATE] = rate
    action[ONSET] = expression.onset_seconds * rate
    action[PEAK] = expression.peak * step
    return action


def picture_of(document):
    """The document's picture, on our own head."""
    person = native.library("composing").canonical_person()
    return native.library("preview").expression_picture(document, person)


def description(expression) -> str:
    kind = "A still" if expression.is_still else f"A motion of {expression.seconds:.2f} s"
    source = f", {expression.source[0]}, frames {expression.source[1]}" if expression.source else ""
    return f"{kind} of {len(expression.channels)} muscles and articulators{source}"


def document_of(action: bpy.types.Action):
    """The action as the package's document, which knows how to mirror, save and compose."""
    curves = compat.curves_in(action)
    channels = [_name_in(curve.data_path) for curve in curves]
    rate = float(action[RATE])
    last = max((curve.range()[1] for curve in curves), default=0.0)
    num_rows = 1 if action[KIND] == STILL else max(2, round(last) + 1)
    values = np.array([[curve.evaluate(row) for curve in curves] for row in range(num_rows)])
    onset, peak = float(action[ONSET]), float(action[PEAK])
    events = np.array([[onset, peak, peak, float(np.abs(values).max(initial=0.0))]])
    document = native.library("expression").Expression
    if num_rows == 1:
        return document(channels, values, np.zeros_like(values), rate)
    return document(channels, values, np.zeros_like(values), rate, [action.name], events)


def peak_values(action: bpy.types.Action, is_mirrored: bool = False) -> dict[str, float]:
    """Values by muscle or articulator at the expression's peak."""
    curves = compat.curves_in(action)
    values = {_name_in(curve.data_path): curve.evaluate(action[PEAK]) for curve in curves}
    return native.library("expression").mirrored_values(values) if is_mirrored else values


def blended(start: dict[str, float], target: dict[str, float], share: float) -> dict[str, float]:
    """Sliders on the way from one to the other; those that the target does not name stay."""
    return {name: value + share * (target[name] - value) for name, value in start.items()}


def sliders_for(obj: bpy.types.Object, values: dict[str, float]) -> dict[str, float]:
    """The values by the names of the face's own keys; those that it lacks are left out."""
    names = by_hand.keys_now(obj)
    keys = obj.data.shape_keys.key_blocks
    return {names[n]: value for n, value in values.items() if n in names and names[n] in keys}


def key_sliders(obj: bpy.types.Object, names, frame: float) -> None:
    """A key at a frame for each of these sliders."""
    for name in names:
        key = obj.data.shape_keys.key_blocks[name]
        key.keyframe_insert("value", frame=frame, group="Expression")


def shape_values(obj: bpy.types.Object) -> dict[str, float]:
    """What the face's muscles, articulators and extras are set to, by their shapes' names."""
    blocks = obj.data.shape_keys.key_blocks
    groups = {entry.shape for entry in obj.mimetic.groups}
    return {
        shape: 0.0 if blocks[name].mute else blocks[name].value
        for shape, name in by_hand.keys_now(obj).items()
        if shape not in groups and name != contact.KEY
    }


def keep_still(obj: bpy.types.Object, rate: float):
    """The document of what the face's sliders are now; raises InvalidInput if all are at rest."""
    values = shape_values(obj)
    rows = np.array([list(values.values())])
    return native.library("cutting").from_curves(list(values), rows, rate, _muscles(obj))


def keep_motion(obj: bpy.types.Object, first: int, last: int, rate: float):
    """The document of what the face's curves do from frame to frame; raises InvalidInput."""
    holder = compat.curves(obj.data.shape_keys)
    if holder is None or not len(holder.fcurves):
        raise native.invalid_input(
            rpt_("{name} has no curves: press Bake, or keep a still").format(name=obj.name)
        )
    if last - first < 2:
        raise native.invalid_input("A motion needs three frames or more")
    shape_of = {name: shape for shape, name in by_hand.keys_now(obj).items()}
    curves = {
        shape_of[name]: curve
        for curve in holder.fcurves
        if curve.data_path.endswith(".value") and (name := _name_in(curve.data_path)) in shape_of
    }
    frames = range(first, last + 1)
    rows = np.array([[curve.evaluate(frame) for curve in curves.values()] for frame in frames])
    return native.library("cutting").from_curves(list(curves), rows, rate, _muscles(obj))


def _muscles(obj: bpy.types.Object) -> list[str]:
    """Names of the shapes whose sliders go from 0 to 1, as muscles' do."""
    return [entry.shape for entry in obj.mimetic.shapes if entry.lowest >= 0]


def _path(name: str) -> str:
    return f'key_blocks["{bpy.utils.escape_identifier(name)}"].value'


def _name_in(path: str) -> str:
    """The key's name in a curve's path."""
    return bpy.utils.unescape_identifier(path.partition('["')[2].rpartition('"]')[0])
