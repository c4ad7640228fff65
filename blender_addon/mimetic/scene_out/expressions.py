# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions as assets: an action of shape keys' values each, a still of one key or a motion.

Its curves have the names of muscles and articulators, not those that keys were given by hand on one
face, so that it serves every face. Frame 0 is the expression's first row.
"""

from __future__ import annotations

import math
from dataclasses import replace

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, native
from . import actions, by_hand, contact, own_keys, strip_curves

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
    channels = [name_in(curve.data_path) for curve in curves]
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
    values = {name_in(curve.data_path): curve.evaluate(action[PEAK]) for curve in curves}
    return native.library("expression").mirrored_values(values) if is_mirrored else values


def blended(start: dict[str, float], target: dict[str, float], share: float) -> dict[str, float]:
    """Sliders on the way from one to the other; those that the target does not name stay."""
    return {name: value + share * (target[name] - value) for name, value in start.items()}


def sliders_for(
    obj: bpy.types.Object, values: dict[str, float], title: str
) -> tuple[dict[str, float], list[str]]:
    """Channels' values by the names of the face's own keys, and channels that move none of them.

    title: the expression's. Raises InvalidInput if all do so.
    """
    row = np.array([list(values.values())])
    shapes, fitted, missing = _fitted(obj, list(values), row, title)
    names = by_hand.keys_now(obj)
    pairs = zip(shapes, fitted[0].tolist(), strict=True)
    return {names[n]: value for n, value in pairs if n in names}, missing


def on_face(obj: bpy.types.Object, document, title: str):
    """The same of a document: by the names of shapes, the document itself where it fits."""
    shapes, values, missing = _fitted(obj, document.channels, document.values, title)
    if shapes == document.channels:
        return document, missing
    fitting = replace(document, channels=shapes, values=values, stds=np.zeros_like(values))
    return fitting, missing


def own_channels(obj: bpy.types.Object, document):
    """A document of what keys of the face do, by the names of shapes and with its gaze: what
    `on_face` and `new_action` made of it."""
    shape_of = {key: shape for shape, key in by_hand.keys_now(obj).items()}
    channels, values = native.library("face_sliders").with_gaze(
        [shape_of.get(name, name) for name in document.channels],
        *(document.values, _lids_per_degree(obj)),
    )
    return replace(document, channels=channels, values=values, stds=np.zeros_like(values))


def _fitted(
    obj: bpy.types.Object, channels: list[str], values: np.ndarray, title: str
) -> tuple[list[str], np.ndarray, list[str]]:
    private, shapes = _private_shapes(obj), by_hand.keys_now(obj)
    kept = [i for i, name in enumerate(channels) if name not in private]
    names, fitted = native.library("face_sliders").without_gaze(
        *([channels[i] for i in kept], values[:, kept]), *(shapes, _lids_per_degree(obj))
    )
    if not any(name in shapes for name in names):
        raise native.invalid_input(
            rpt_("{name} has none of the muscles that {expression} moves").format(
                name=obj.name, expression=title
            )
        )
    missing = [name for name in channels if name in private]
    return names, fitted, missing + [name for name in names if name not in shapes]


def missing_text(obj: bpy.types.Object, missing: list[str]) -> str:
    """The end of a message on what of an expression the face cannot do, "" for nothing."""
    if not missing:
        return ""
    text = rpt_("; {name} has no {what}")
    return text.format(name=obj.name, what=by_hand.told(missing))


def key_sliders(obj: bpy.types.Object, names, frame: float) -> None:
    """A key at a frame for each of these sliders."""
    for name in names:
        key = obj.data.shape_keys.key_blocks[name]
        key.keyframe_insert("value", frame=frame, group="Expression")


def shape_values(obj: bpy.types.Object) -> dict[str, float]:
    """What the muscles, articulators, eyes and extras are set to, as an expression has it."""
    blocks = obj.data.shape_keys.key_blocks
    names = _own_keys(obj)
    row = [0.0 if blocks[name].mute else blocks[name].value for name in names.values()]
    channels, values = _as_channels(obj, list(names), np.array([row]))
    values = np.clip(values, *_limits(obj, channels))
    return dict(zip(channels, values[0].tolist(), strict=True))


def keep_still(obj: bpy.types.Object, rate: float):
    """The document of what the face's sliders are now; raises InvalidInput if all are at rest."""
    values = shape_values(obj)
    rows = np.array([list(values.values())])
    return _kept(obj, list(values), rows, rate)


def keep_motion(scene: bpy.types.Scene, obj: bpy.types.Object, first: int, last: int, rate: float):
    """The document of what the face's curves, its strips or its control object do from frame to
    frame; raises InvalidInput."""
    keys, names = obj.data.shape_keys, _own_keys(obj)
    holder = compat.curves(keys)
    is_shown = strip_curves.plays(keys) or not own_keys.driven_keys(keys).isdisjoint(names.values())
    if not is_shown and (holder is None or not len(holder.fcurves)):
        raise native.invalid_input(
            rpt_("{name} has no curves: press Bake, or keep a still").format(name=obj.name)
        )
    if last - first < 2:
        raise native.invalid_input("A motion needs three frames or more")
    frames, own = np.arange(first, last + 1), [keys.key_blocks[name] for name in names.values()]
    rows = _shown(scene, own, frames) if is_shown else _by_curves(holder, own, frames)
    return _kept(obj, *_as_channels(obj, list(names), rows), rate)


def _by_curves(holder, own: list[bpy.types.ShapeKey], frames) -> np.ndarray:
    """N x S: values of keys by their curves."""
    by_path = {curve.data_path: curve for curve in holder.fcurves}
    columns = []
    for key in own:
        curve = by_path.get(_path(key.name))
        # An eye turns by several shapes: one without a curve counts as it stands
        columns.append(
            np.full(len(frames), key.value)
            if curve is None
            else np.array([curve.evaluate(frame) for frame in frames])
        )
    return np.array(columns).T


def _shown(scene: bpy.types.Scene, own: list[bpy.types.ShapeKey], frames) -> np.ndarray:
    """N x S: values of keys as frames show them; the scene's frame stays."""
    current, rows = scene.frame_current_final, []
    try:
        for frame in frames:
            scene.frame_set(int(frame))
            rows.append([key.value for key in own])
    finally:
        scene.frame_set(math.floor(current), subframe=current % 1)
    return np.array(rows)


def _kept(obj: bpy.types.Object, channels: list[str], rows: np.ndarray, rate: float):
    cutting = native.library("cutting")
    return cutting.from_curves(channels, rows, rate, _limits(obj, channels))


def _own_keys(obj: bpy.types.Object) -> dict[str, str]:
    """Name of the key that is each shape now, of those that other faces may have, too."""
    private, keys = _private_shapes(obj), obj.data.shape_keys.key_blocks
    return {
        shape: name
        for shape, name in by_hand.keys_now(obj).items()
        if shape not in private and name in keys and name != contact.KEY
    }


def _private_shapes(obj: bpy.types.Object) -> set[str]:
    """Those that correct one performance's skin: other faces' of these names do something else."""
    parts, entries = native.shapes(), by_hand.entries_of(obj)
    return {n for n, entry in entries.items() if entry.group in (parts.CONTACT, parts.DETAIL)}


def _as_channels(
    obj: bpy.types.Object, names: list[str], rows: np.ndarray
) -> tuple[list[str], np.ndarray]:
    """Values of the face's sliders (N x S) as channels of an expression."""
    sliders = native.library("face_sliders")
    members = {
        entry.shape: [
            one.shape
            for one in obj.mimetic.shapes
            if one.group == entry.group
            and one.shape.endswith(entry.shape.removeprefix(entry.group))
        ]
        for entry in obj.mimetic.groups
    }
    return sliders.with_gaze(*sliders.with_groups(names, rows, members), _lids_per_degree(obj))


def _lids_per_degree(obj: bpy.types.Object) -> tuple[float, ...]:
    return tuple(obj.mimetic.lid_following)[::2]


def _limits(obj: bpy.types.Object, channels: list[str]) -> np.ndarray:
    """Least and greatest values, 2 x C, as the face's sliders reach."""
    keys = obj.data.shape_keys.key_blocks
    reach = {
        shape: (keys[name].slider_min, keys[name].slider_max)
        for shape, name in _own_keys(obj).items()
    }
    return native.library("face_sliders").limits_on(channels, reach)


def _path(name: str) -> str:
    return f'key_blocks["{bpy.utils.escape_identifier(name)}"].value'


def name_in(path: str) -> str:
    """The key's name in a curve's path."""
    return bpy.utils.unescape_identifier(path.partition('["')[2].rpartition('"]')[0])
