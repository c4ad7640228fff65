# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on the shape keys that a character's maker gave it: no key, no mesh is changed."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import bpy
from bpy.app.translations import pgettext_rpt as rpt_

from .. import heads, native, scene_in, world, writable
from . import actions, baked_curves, bound, companions, head, own_keys, standing

GROUP = "Face"  # what the curves are listed under


@dataclass(frozen=True)
class BakeSummary:
    first: float  # scene frames of the first and the last key
    last: float
    num_curves: int
    text: str  # which controls were driven, which not, what share of the motion is explained


def bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    character: bpy.types.Object,
    played,
    footage: bpy.types.MovieClip | None = None,
    use_head_motion: bool = True,
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> BakeSummary:
    """Keys a `mimetic.retarget.PlayedControls` on a character's own shape keys, in a new action.

    What else the character's action holds goes on in a copy. use_head_motion: whether the object
    moves as the actor's head; it never does where a parent, an armature or a constraint moves it.
    Keys of the same names on the character's other meshes, teeth and eyes, get the same curves.
    What a bake before drove and this one does not, muscles too, is at rest then.
    tolerance, by_phases: of few keys, as `actions.key_shapes` has them.
    Raises InvalidInput, and changes nothing then, where keys were removed meanwhile.
    """
    writable.check(writable.no_sliders(character))
    holders = own_keys.holders(character)
    names = {name for _, keys in holders for name in keys}
    if missing := [name for name in played.names if name not in names]:
        raise native.invalid_input(
            rpt_("{name} has no shape key {key} any more: fit its controls again").format(
                name=character.name, key=missing[0]
            )
        )
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    remark = _moved_by_another(character) if use_head_motion else ""
    use_head_motion = use_head_motion and not remark
    if use_head_motion:
        writable.check(writable.no_motion(character))
    curves = dict(zip(played.names, played.values.T, strict=True))
    num_curves, num_rested, others = 0, 0, []
    for obj, keys in holders:
        own = {name: key for name, key in keys.items() if name in curves}
        if not own and obj != character:
            continue
        name = f"{take} controls" if obj == character else f"{take} {obj.name}"
        holder = actions.continued_take(obj.data.shape_keys, name)
        for name, key in own.items():
            actions.key_slider(holder, key, GROUP, frames, curves[name], tolerance, by_phases)
        num_rested += baked_curves.replace(
            obj.data.shape_keys, {(key.path_from_id("value"), 0) for key in own.values()}
        )
        num_curves += len(own)
        others += [] if obj == character else [obj]
    if rested := baked_curves.at_rest(num_rested, character.name):
        remark += f"; {rested}"
    companions.remember(character, others)
    if others:
        names = ", ".join(obj.name for obj in others)
        remark += rpt_("; {names} moved along").format(names=names)
    if use_head_motion:
        num_curves += _key_head(scene, performance, take, character, frames)
    return BakeSummary(float(frames[0]), float(frames[-1]), num_curves, played.summary() + remark)


def _moved_by_another(character: bpy.types.Object) -> str:
    """What to say of a head whose motion is left to what moves it, or the empty string."""
    mover = bound.moved_by(character)
    text = rpt_("; {character} is moved by {mover}: bake the head's motion on that")
    return text.format(character=character.name, mover=mover) if mover else ""


def _key_head(scene, performance, take: str, character, frames) -> int:
    """Keys the motion of a head that nothing else moves; returns the number of curves."""
    if scene_in.is_face(character):
        channels = bound.motion(scene, performance, character)
    else:
        channels = _motion(scene, performance, character)
    return head.key_object(character, take, frames, channels)


def _motion(scene: bpy.types.Scene, performance, character: bpy.types.Object):
    """`mimetic.rig_motion.Channels` of a character without muscles."""
    units = 1.0 / (scene.unit_settings.scale_length or 1.0)
    with standing.at_rest(character):
        return native.bound_head().head_channels(
            performance,
            _world_from_character(scene, character, units),
            native.array(character.location),
            native.array(world.own_rotation(character)),
            character.rotation_mode,
            units,
        )


def _world_from_character(scene: bpy.types.Scene, character: bpy.types.Object, units: float):
    """4 x 4: by landmarks if there are some, else by what the own controls move."""
    parts, own = native.bound_head(), heads.bound_head(scene, character, "NONE")
    stands = native.array(world.matrix(character))
    if set(native.self_landmarks().REQUIRED) <= own.landmarks.keys():
        with suppress(*native.known_errors()):  # of a face's mirror image, or of no face
            place = parts.object_from_character(own.points, own.landmarks, own.matrix)
            return stands @ place
    surface = own_keys.surface(character)
    moved = (surface.controls**2).sum(axis=(0, 2))
    return native.core().world_from_moved_head(
        surface.points, surface.starts.tolist(), surface.corners.tolist(), moved, stands, units
    )


def play(performance, character: bpy.types.Object, preset: str | None = None):
    """`mimetic.retarget.PlayedControls` of a character; raises InvalidInput.

    preset: path of a table; controls that it lacks are driven as at first.
    """
    writable.check(own_keys.no_own_keys(character))
    surface = own_keys.surface(character)
    return play_surface(performance, character, surface, preset)


def play_surface(
    performance, character: bpy.types.Object, surface, preset: str | None = None, options=None
):
    """`mimetic.retarget.PlayedControls` of a `mimetic.retarget.ControlSurface` of a character's, by
    a preset's table if one is given. options: of the fit. Raises InvalidInput."""
    rows, strangers = None, []
    if preset is not None:
        package = native.controls()
        first = package.refitted([], surface.ranges)
        rows, strangers = with_preset(character, first, package.load_preset(preset))
    played = native.playing().play(performance, surface, rows, options)
    return replace(played, strangers=strangers)


def with_preset(character: bpy.types.Object, rows, preset) -> tuple[list, list[str]]:
    """Rows as a preset has them, and what of it the character lacks; raises InvalidInput where
    that is all of it."""
    rows, strangers = native.controls().with_preset(rows, preset)
    if len(strangers) == len(preset):
        raise native.invalid_input(
            rpt_("{character} has none of the preset's controls").format(character=character.name)
        )
    return rows, strangers


def check_no_preset(obj: bpy.types.Object, preset: str | None) -> None:
    """Raises InvalidInput for a preset of an object of which no own control plays."""
    if preset is None:
        return
    reason = (
        rpt_(
            "{name} is played by its muscles, which no preset is for: leave --preset out, or give "
            "--controls own"
        )
        if scene_in.is_face(obj)
        else rpt_("{name} has no controls that a preset is for: leave --preset out")
    )
    raise native.invalid_input(reason.format(name=obj.name))
