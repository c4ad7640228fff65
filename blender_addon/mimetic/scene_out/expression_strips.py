# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions one after the other and over each other: strips in the NLA of a face's sliders."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import bpy
import numpy as np

from .. import compat, native
from . import actions, by_hand, expressions, strip_values

TRACK = "Expressions"
REST = "At Rest"


@dataclass(frozen=True)
class Sequenced:
    first: float  # scene frames
    last: float
    pushed_down: str = ""  # the take that became a strip under the expressions
    missing: list[str] = field(default_factory=list)  # channels that move nothing of the face


def sequence(
    obj: bpy.types.Object,
    action: bpy.types.Action,
    frame: float,
    rate: float,
    is_mirrored: bool = False,
    strength: float = 1.0,
) -> Sequenced:
    """A strip in which the expression begins to move at a scene frame.

    Curves of the face's own become a strip under it, as Push Down does, or they would hide it.
    Raises InvalidInput where no key of the face is moved.
    """
    strip_action, missing = _action_for(obj, action, rate, is_mirrored)
    animation = compat.animation_of(obj.data.shape_keys)
    pushed_down = _push_down(animation)
    _rest_under(animation, strip_action)
    stretch = rate / float(strip_action[expressions.RATE])
    length = stretch * _length(strip_action)
    start = frame - stretch * float(strip_action[expressions.ONSET])
    track = _free_track(animation, start, start + length)
    strip = compat.add_strip(track, action.name, start, strip_action)
    strip.scale = stretch
    strip.extrapolation = "NOTHING"
    if strength != 1:
        strip.use_animated_influence = True  # makes the curve that is keyed here
        strip.fcurves.find("influence").keyframe_points.insert(start, strength)
    return Sequenced(strip.frame_start, strip.frame_end, pushed_down, missing)


def strips_of(obj: bpy.types.Object) -> list[bpy.types.NlaStrip]:
    """The face's expression strips that play, in the order of time."""
    animation = obj.data.shape_keys.animation_data if obj.data.shape_keys else None
    strips = [
        strip
        for track in (animation.nla_tracks if animation else ())
        if not track.mute
        for strip in track.strips
        if not strip.mute and strip.action and expressions.is_expression(strip.action)
    ]
    return sorted(strips, key=lambda strip: strip.frame_start)


def compose(obj: bpy.types.Object, name: str, rate: float) -> Sequenced:
    """A new expression of all that the strips play together, on a track above; theirs are muted.

    Strips play as in Blender, however they are cut, repeated, turned or faded. Where several move
    the same muscle the one nearer to its peak prevails, and nothing adds up, as `mimetic library
    compose` does it. Raises InvalidInput.
    """
    strips = strips_of(obj)
    first = math.floor(strips[0].frame_start)
    last = math.ceil(max(strip.frame_end for strip in strips))
    frames, composing = np.arange(first, last + 1), native.library("composing")
    pairs = [
        (composing.Placing(strip.action.name), _document_of(obj, strip, frames, rate))
        for strip in strips
    ]
    names = list(dict.fromkeys(name for _, one in pairs for name in one.channels))
    values, stds = composing.play(pairs, names, rate)
    document = native.library("expression").Expression(names, values, stds, rate)
    action = expressions.new_asset(name, document, rate, expressions.picture_of(document))
    for track in obj.data.shape_keys.animation_data.nla_tracks:
        if any(strip in strips for strip in track.strips):
            track.mute = True
    return sequence(obj, action, first, rate)


def _document_of(obj: bpy.types.Object, strip: bpy.types.NlaStrip, frames: np.ndarray, rate: float):
    """What a strip plays at N scene frames, at rest where it does not."""
    curves = compat.curves_in(strip.action)
    values = strip_values.of(strip, curves, frames)
    channels = [expressions.name_in(curve.data_path) for curve in curves]
    document = native.library("expression").Expression
    return expressions.own_channels(obj, document(channels, values, np.zeros_like(values), rate))


def _action_for(
    obj: bpy.types.Object, action: bpy.types.Action, rate: float, is_mirrored: bool
) -> tuple[bpy.types.Action, list[str]]:
    """The asset itself where it fits the face, else an action of the face's own; and channels that
    move nothing of the face."""
    names = by_hand.keys_now(obj)
    asset = expressions.document_of(action)
    document = asset.mirrored() if is_mirrored else asset
    if document.is_still:
        document = native.library("composing").motion_of_still(document, rate)
    document, missing = expressions.on_face(obj, document, action.name)
    is_renamed = any(names.get(name, name) != name for name in document.channels)
    is_changed = is_mirrored or asset.is_still or document.channels != asset.channels
    if not (is_changed or is_renamed):
        return action, missing
    title = f"{action.name} on {obj.name}"
    return expressions.new_action(title, document, rate, names), missing


def _length(action: bpy.types.Action) -> float:
    return max(float(curve.range()[1]) for curve in compat.curves_in(action))


def _push_down(animation: bpy.types.AnimData) -> str:
    """Makes the action a strip of the lowest track; returns its name, "" without one."""
    action = animation.action
    if action is None:
        return ""
    track = animation.nla_tracks.new()
    track.name = action.name
    compat.add_strip(track, action.name, action.frame_range[0], action)
    animation.action = None
    return action.name


def _rest_under(animation: bpy.types.AnimData, action: bpy.types.Action) -> None:
    """Has the action's sliders at 0 where no strip plays, by a track under the expressions'.

    Blender 5.0 puts them to 1 there, the value that new shape keys get.
    """
    strips = [strip for track in animation.nla_tracks for strip in track.strips if strip.action]
    other_paths = {
        curve.data_path
        for strip in strips
        if not expressions.is_expression(strip.action)
        for curve in compat.curves_in(strip.action)
    }
    paths = [c.data_path for c in compat.curves_in(action) if c.data_path not in other_paths]
    if not paths:
        return
    resting, holder = compat.free_action(REST, expressions.KEY_TYPE)
    for path in paths:
        actions.fill(
            compat.new_curve(holder, path, 0, REST), (0.0, 1.0), (0.0, 0.0), actions.LINEAR
        )
    below = [track for track in animation.nla_tracks if track.name.split(".")[0] == REST]
    # Without one there are no expressions yet either: it comes above the take alone
    track = animation.nla_tracks.new(prev=below[-1]) if below else animation.nla_tracks.new()
    track.name = REST
    compat.add_strip(track, REST, 0.0, resting)


def _free_track(animation: bpy.types.AnimData, start: float, end: float) -> bpy.types.NlaTrack:
    for track in animation.nla_tracks:
        is_free = all(s.frame_end <= start or s.frame_start >= end for s in track.strips)
        if track.name.split(".")[0] == TRACK and is_free and not track.mute and not track.lock:
            return track
    track = animation.nla_tracks.new()
    track.name = TRACK
    return track
