# SPDX-License-Identifier: GPL-3.0-or-later
"""The takes of a face or a character: which actions each has, which plays, which were edited."""

from __future__ import annotations

import datetime
import hashlib
from collections.abc import Callable

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, native
from ..takes import note_baked
from . import (
    by_hand,
    companions,
    control_object,
    key_table,
    renamed_keys,
    rest_pose,
    standing,
    take_strips,
)
from .renamed_keys import KEYS

OBJECT, CONTROL = "OBJECT", "CONTROL"


def owners(obj: bpy.types.Object | None) -> dict[str, bpy.types.ID]:
    """What of a face or character actions may move."""
    if obj is None:
        return {}
    blocks = {OBJECT: obj, CONTROL: control_object.of(obj)}
    blocks[KEYS] = obj.data.shape_keys if obj.type == "MESH" else None
    blocks |= {f"{KEYS} {name}": keys for name, keys in companions.remembered(obj).items()}
    return {name: block for name, block in blocks.items() if block is not None}


def now(obj: bpy.types.Object | None) -> dict[str, tuple]:
    """The action that moves each owner, or our uppermost strip's, and its slot."""
    current = {}
    for name, block in owners(obj).items():
        animation = block.animation_data
        if animation is not None and animation.action is not None:
            current[name] = animation.action, compat.slot_of(animation)
        elif (strip := take_strips.top(block)) is not None:
            current[name] = strip.action, compat.slot_of(strip)
    return current


def leave_tweak_mode(obj: bpy.types.Object | None) -> None:
    """Closes strips of a face or character that are open in the NLA (Tab)."""
    for block in owners(obj).values():
        compat.leave_tweak_mode(block)


def before_bake(obj: bpy.types.Object | None) -> dict[str, tuple]:
    """As `now`, once strips that are open are closed: a bake goes on from what they lead to."""
    leave_tweak_mode(obj)
    return now(obj)


def note(obj, performance, name: str, path: str, frames, settings: str, before: dict):
    """Adds the take that was just baked to the list, and returns its row.

    path: of the performance's file; frames: N, of the scene; before: of `before_bake`, whose
    actions are not its.
    """
    facts = native.take_facts().facts_of(performance)
    renamed_keys.follow(obj)
    for block in owners(obj).values():
        take_strips.clear(block)  # of the takes before, which stay in the list
    row = obj.mimetic.takes.add()
    row.name = _free_name(obj, name)
    if performance.footage:
        row.clip, row.footage = (
            native.shown_text().shown(performance.footage[0]),
            performance.footage[1],
        )
    note_baked(row, path)
    row.first, row.last, row.quality = facts.first, facts.last, facts.quality
    row.scene_first, row.scene_last = float(frames[0]), float(frames[-1])
    row.num_lost = facts.num_held
    for first, last in facts.held:
        lost = row.lost.add()
        lost.first, lost.last = float(frames[first]), float(frames[last])
    row.date = datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    row.settings = settings
    for owner, (action, slot) in now(obj).items():
        if (action, slot) != before.get(owner):
            part = row.parts.add()
            part.name, part.action, part.slot = owner, action, slot
            part.handle = compat.handle_of(action, slot)
    _rest_of_what_left(obj, [(owner, *played) for owner, played in before.items()], [row])
    row.mark, row.surface = mark_of(row), _surface_of(obj)
    obj.mimetic.active_take = len(obj.mimetic.takes) - 1
    return row


def playing(obj: bpy.types.Object | None):
    """The row of the take whose actions move the face now, or None."""
    if obj is None:
        return None
    current = now(obj)
    return next((row for row in reversed(obj.mimetic.takes) if plays(row, current)), None)


def plays(row, current: dict) -> bool:
    """Whether a take's actions are all among `now`'s; a companion may be gone."""
    parts = {
        part.name: (part.action, part.slot_now)
        for part in row.parts
        if part.name in current or part.name in (KEYS, OBJECT, CONTROL)
    }
    return bool(parts) and all(current.get(owner) == part for owner, part in parts.items())


def find(obj: bpy.types.Object, name: str):
    """A take by its name, or the row that is shown; raises InvalidInput."""
    takes = obj.mimetic.takes
    if name and name not in takes:
        names = ", ".join(row.name for row in takes) or rpt_("none")
        raise native.invalid_input(
            rpt_("{name} has no take {take}: it has {names}").format(
                name=obj.name, take=name, names=names
            )
        )
    if name:
        return takes[name]
    if not 0 <= obj.mimetic.active_take < len(takes):
        raise native.invalid_input(rpt_("{name} has no take yet: press Bake").format(name=obj.name))
    return takes[obj.mimetic.active_take]


def is_inherited(obj: bpy.types.Object, row) -> bool:
    """Whether a library override has a take from the file that it comes from, and would again."""
    override = obj.override_library
    return bool(override and override.reference and row.name in override.reference.mimetic.takes)


def is_edited(row) -> bool:
    """Whether curves of a take are no longer as they were baked; the row remembers it."""
    # Files of earlier versions have marks by bones' names
    row.is_edited = row.is_edited or row.mark not in (mark_of(row), mark_of(row, has_bones=True))
    return row.is_edited


def mark_of(row, has_bones: bool = False) -> str:
    """Of all keys of a take's curves; the same once shape keys of ours or bones were renamed.

    has_bones: with the names of bones. Without, curves of several follow each other as they do in
    the action, so that to exchange theirs is an edit.
    """
    digest, obj = hashlib.sha256(), row.id_data
    shapes = by_hand.shapes_by_name(obj) if KEYS in owners(obj) else {}
    for part in row.parts:
        of_part = shapes if part.name == KEYS else {}
        curves = compat.curves_of(part.action, part.slot_now) if part.action else ()
        paths = [(renamed_keys.lasting_path(c.data_path, of_part), c.array_index) for c in curves]
        if not has_bones:
            paths = [(renamed_keys.without_bone(path), index) for path, index in paths]
        for (path, index), curve in sorted(zip(paths, curves, strict=True), key=lambda row: row[0]):
            digest.update(f"{part.name} {path} {index}".encode())
            digest.update(key_table.mark(curve))
    return digest.hexdigest()


def no_play(obj: bpy.types.Object, row) -> str:
    """Why a take cannot play, or nothing."""
    names = {part.name for part in row.parts}
    if not names or any(part.action is None for part in row.parts):
        return iface_("the actions of {take} were removed: bake it again").format(take=row.name)
    if gone := next((part for part in row.parts if part.slot_now is None), None):
        return iface_(
            "{action} no longer has the slot {slot}, by which {take} plays: give its slot that "
            "name again, or bake it again"
        ).format(action=gone.action.name, slot=gone.slot[2:], take=row.name)
    if CONTROL in names and control_object.of(obj) is None:
        return iface_(
            "{take} is of a control object, which {name} no longer has: add it again"
        ).format(take=row.name, name=obj.name)
    if CONTROL not in names and KEYS in names and (control := control_object.of(obj)):
        return iface_(
            "{take} is on {name}'s shape keys, which {control} drives: press "
            "Remove Control Object first"
        ).format(take=row.name, name=obj.name, control=control.name)
    return ""


def _surface_of(obj: bpy.types.Object) -> str:
    """Of the shapes of contact and detail that the face has now, which a bake makes anew."""
    digest = hashlib.sha256()
    for entry in _rest_of(obj):
        shape = entry.shape or entry.name
        digest.update(f"{shape} ".encode() + np.array(entry.offsets, np.float32).tobytes())
    return digest.hexdigest()


def _rest_of(obj: bpy.types.Object) -> list:
    parts = native.shapes()
    return [entry for entry in obj.mimetic.shapes if entry.group in (parts.CONTACT, parts.DETAIL)]


def _suit(obj: bpy.types.Object, row) -> bool:
    """Has a take move shapes of contact and detail only if they were made for it; says whether.
    Else lips and lids are kept apart as when sliders are moved by hand."""
    if KEYS not in row.parts or not (rest := _rest_of(obj)):
        return True
    is_own, keys = row.surface == _surface_of(obj), obj.data.shape_keys
    held = keys.key_blocks if keys is not None else {}  # none where they were applied
    blocks = [held[entry.name] for entry in rest if entry.name in held]
    paths = {block.path_from_id("value") for block in blocks}
    part = row.parts[KEYS]
    for curve in compat.curves_of(part.action, part.slot_now):
        if curve.data_path in paths:
            curve.mute = not is_own
    if not is_own:
        for block in blocks:
            block.value = 0.0
    return is_own


def play(obj: bpy.types.Object, row) -> bool:
    """Has a take move the face alone; says whether contact and detail are its own. Raises
    InvalidInput, and changes nothing then."""
    if reason := no_play(obj, row):
        raise native.invalid_input(reason)
    leave_tweak_mode(obj)
    renamed_keys.follow(obj)
    leaving, of_takes = _all_now(obj), actions_of_takes(obj)
    for block in owners(obj).values():
        take_strips.clear(block)
    parts = {part.name: part for part in row.parts}
    for owner, block in owners(obj).items():
        if owner in parts:
            compat.assign(block, parts[owner].action, parts[owner].slot_now)
        elif block.animation_data is not None and block.animation_data.action in of_takes:
            compat.unassign(block)
    _rest_of_what_left(obj, leaving, [row])
    obj.mimetic.active_take = obj.mimetic.takes.find(row.name)
    return _suit(obj, row)


def gone_keys(obj: bpy.types.Object, *rows) -> str:
    """What of takes moves nothing as shape keys or bones are gone, for a message; or nothing."""
    blocks, lines = owners(obj), []
    for row in rows:
        if names := renamed_keys.gone(row, blocks):
            lines.append(
                rpt_(
                    "{name} has no shape key {keys} any more, which {take} moves: give it its name "
                    "again, or bake the take again"
                ).format(name=obj.name, keys=by_hand.told(names), take=row.name)
            )
        lines += [
            rpt_(
                "{name} has no bone {bones} any more, which {take} moves: give it its name again, "
                "or bake the take again"
            ).format(name=name, bones=by_hand.told(bones), take=row.name)
            for name, bones in renamed_keys.gone_bones(row, blocks).items()
        ]
    return "; ".join(lines)


def shared(obj: bpy.types.Object) -> str:
    """What to say of a mesh that other objects have, too, as its sliders are one and the same."""
    if obj.type != "MESH":
        return ""
    others = [other for other in bpy.data.objects if other.data == obj.data and other != obj]
    if not (names := [other.name for other in others if other.users_scene]):
        return ""
    return rpt_(
        "{name}'s sliders are those of {others}, too, as they share a mesh: to part them, "
        "Object > Relations > Make Single User > Object & Data"
    ).format(name=obj.name, others=by_hand.told(names))


def actions_of_takes(obj: bpy.types.Object) -> set[bpy.types.Action]:
    return {part.action for row in obj.mimetic.takes for part in row.parts}


def _all_now(obj: bpy.types.Object) -> list[tuple]:
    """As `now`, with all of our strips: owner, action and slot of each."""
    strips = [
        (owner, strip.action, compat.slot_of(strip))
        for owner, block in owners(obj).items()
        for strip in take_strips.strips_of(block)
    ]
    return [(owner, *playing) for owner, playing in now(obj).items()] + strips


def _rest_of_what_left(obj: bpy.types.Object, leaving: list[tuple], rows: list) -> None:
    """Puts to rest what actions that play no longer (of `_all_now`) have moved, and the takes that
    play do not: it would stay as the frame at hand had it. The object goes to where it stood.

    Of an action of the user's own, such as of Bake Action, only what these takes move too.
    """
    blocks, current, of_takes = owners(obj), now(obj), actions_of_takes(obj)
    for owner, action, slot in leaving:
        if owner not in blocks or current.get(owner) == (action, slot):
            continue
        parts = [row.parts[owner] for row in rows if owner in row.parts]
        own = [curve for part in parts for curve in compat.curves_of(part.action, part.slot_now)]
        played = {(curve.data_path, curve.array_index) for curve in own}
        moved = {rest_pose.moved_by(path) for path, _ in played}
        for curve in compat.curves_of(action, slot):
            path, index = curve.data_path, curve.array_index
            is_ours = action in of_takes or rest_pose.moved_by(path) in moved
            if is_ours and (path, index) not in played:
                rest_pose.put_to_rest(blocks[owner], path, index)
                if owner == OBJECT:
                    standing.put_back(obj, action, {path})


def blend(obj: bpy.types.Object, under, over, influence: float) -> None:
    """Has one take play over another, as strips; raises InvalidInput, and changes nothing then."""
    for row in (under, over):
        if reason := no_play(obj, row):
            raise native.invalid_input(reason)
    if under.name == over.name:
        raise native.invalid_input(
            rpt_("{take} plays already: choose another take to blend in").format(take=over.name)
        )
    leave_tweak_mode(obj)
    renamed_keys.follow(obj)
    leaving = _all_now(obj)
    take_strips.play(owners(obj), [(under, 1.0), (over, influence)])
    _rest_of_what_left(obj, leaving, [under, over])
    for row in (under, over):
        _suit(obj, row)


def as_strips(obj: bpy.types.Object, row) -> None:
    """Has a take play as strips, which leaves room for keys and strips of the user's above."""
    take_strips.play(owners(obj), [(row, 1.0)])


def remove(obj: bpy.types.Object, row) -> list[str]:
    """Takes a row off the list, and its actions out of the file where nothing else uses them;
    returns their names. Raises InvalidInput, and changes nothing then."""
    if is_inherited(obj, row):
        raise native.invalid_input(
            rpt_("{take} is a take of the file that {name} is linked from: remove it there").format(
                take=row.name, name=obj.name
            )
        )
    index = obj.mimetic.takes.find(row.name)
    parts = [part.action for part in row.parts if part.action is not None]
    leave_tweak_mode(obj)
    is_playing, leaving = plays(row, now(obj)), _all_now(obj)
    obj.mimetic.takes.remove(index)
    kept = {part.action for other in obj.mimetic.takes for part in other.parts}
    gone = [action for action in dict.fromkeys(parts) if action not in kept]
    for block in owners(obj).values():
        take_strips.clear(block, gone)
        if is_playing and block.animation_data and block.animation_data.action in gone:
            compat.unassign(block)
    if OBJECT not in now(obj):
        for action, slot in [playing[1:] for playing in leaving if playing[0] == OBJECT]:
            standing.put_back(obj, action, compat.paths_of(action, slot))
    names = []
    for action in gone:
        action.use_fake_user = False
        if action.users <= compat.left_references(action):
            names.append(action.name)
            bpy.data.actions.remove(action)
    obj.mimetic.active_take = min(max(index - 1, 0), max(len(obj.mimetic.takes) - 1, 0))
    return names


def retime(row, moved: Callable[[list[float]], list[float]]) -> None:
    """Has what a take notes of the scene's time go along with its curves; moved: scene frames to
    where they are now."""
    row.scene_first, row.scene_last = moved([row.scene_first, row.scene_last])
    for lost in row.lost:
        lost.first, lost.last = moved([lost.first, lost.last])


def _free_name(obj: bpy.types.Object, name: str) -> str:
    number, free = 1, name
    while free in obj.mimetic.takes:
        number += 1
        free = f"{name}.{number:03d}"
    return free
