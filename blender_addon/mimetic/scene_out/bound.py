# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character whose head has the muscles' sliders: its own shapes, our curves.

Its mesh, materials, slider limits and its curves of anything else stay as they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix

from .. import heads, native, scene_in, world, writable
from . import actions, baked_curves, by_hand, companions, gaze, head, own_keys, standing


@dataclass(frozen=True)
class BakeSummary:
    first: float  # scene frames of the first and the last key
    last: float
    num_curves: int
    has_motion: bool  # whether the head's motion was keyed on the object
    left_out: tuple[str, ...]  # what the head does not play, in sentences
    untouched: tuple[str, ...]  # sliders that the performance does not move


def bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    head_object: bpy.types.Object,
    footage: bpy.types.MovieClip | None = None,
    use_head_motion: bool = True,
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> BakeSummary:
    """Keys a `mimetic.performance.Performance` on the sliders of a head, by the names that muscles
    had when they were attached: a slider that was renamed by hand plays, too.

    use_head_motion: whether the object moves as the actor's head does, from where it stands; it
    never does where a parent, an armature or a constraint moves it. tolerance, by_phases: of few
    keys, as `actions.key_shapes` has them. Own controls that a bake before drove are at rest then.
    The scene's rate and range stay. Raises InvalidInput,
    and changes nothing then, if nothing of it can be played.
    """
    writable.check(writable.no_sliders(head_object))
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    shapes = shapes_for(performance, head_object)
    keys = head_object.data.shape_keys
    sliders = sliders_of(head_object, shapes)
    driven_keys = own_keys.driven_keys(keys)
    playable = [
        (key, shape)
        for shape in shapes
        if (key := sliders.get(shape.name)) and key.name not in driven_keys
    ]
    remarks = no_play(head_object, shapes, sliders, driven_keys)
    if not playable:
        raise native.invalid_input("; ".join(remarks))
    if use_head_motion and (remark := no_motion(head_object)):
        use_head_motion = False
        remarks.append(remark)
    channels = motion(scene, performance, head_object) if use_head_motion else None
    holder = actions.continued_take(keys, f"{take} muscles")
    if stale := _silence(head_object, holder, shapes):
        remarks.append(
            rpt_("an earlier take's {names} on {head} is at 0 now").format(
                names=", ".join(stale), head=head_object.name
            )
        )
    for key, shape in playable:
        actions.key_slider(holder, key, shape.group, frames, shape.values, tolerance, by_phases)
    remarks += _rest_own_controls(head_object, take, [key for key, _ in playable])
    num_curves = len(playable)
    if channels is not None:
        num_curves += head.key_object(head_object, take, frames, channels)
    return BakeSummary(
        float(frames[0]),
        float(frames[-1]),
        num_curves,
        channels is not None,
        tuple(remarks),
        tuple(untouched_by(head_object, {shape.name for shape in shapes})),
    )


def _rest_own_controls(head: bpy.types.Object, take: str, muscles: Sequence) -> list[str]:
    """Puts to rest what a bake before drove beyond the muscles' keys, of the head and of what its
    own controls moved along; what to say of it."""
    paths = {(key.path_from_id("value"), 0) for key in muscles}
    num_rested = baked_curves.replace(head.data.shape_keys, paths)
    for name, keys in companions.remembered(head).items():
        if baked_curves.play(keys):
            actions.continued_take(keys, f"{take} {name}")
            num_rested += baked_curves.replace(keys, ())
    return list(filter(None, [baked_curves.at_rest(num_rested, head.name)]))


def no_motion(head: bpy.types.Object) -> str:
    """Why the head's motion is not keyed on an object, or the empty string."""
    mover = moved_by(head)
    if not mover:
        return ""
    return iface_(
        "{head} is moved by {mover}: the head's motion is left to Bake Head (panel Head)"
    ).format(head=head.name, mover=mover)


def moved_by(head: bpy.types.Object) -> str:
    """What moves an object beside its own curves, or the empty string."""
    if head.parent:
        return head.parent.name
    for modifier in head.modifiers:
        if modifier.type == "ARMATURE" and modifier.object:
            return modifier.object.name
    if constraint := next((c for c in head.constraints if not c.mute), None):
        return iface_("its constraint {constraint}").format(constraint=constraint.name)
    if _has_deltas(head):
        return iface_("its delta transforms")
    if any(path.startswith(("location", "rotation")) for path in actions.driver_paths(head)):
        return iface_("its drivers")
    return ""


def _has_deltas(obj: bpy.types.Object) -> bool:
    return any((*obj.delta_location, *obj.delta_rotation_euler)) or (
        tuple(obj.delta_rotation_quaternion) != (1, 0, 0, 0)
    )


def motion(scene: bpy.types.Scene, performance, head: bpy.types.Object):
    """`mimetic.rig_motion.Channels` of a head with muscles, which turns about its centre."""
    with standing.at_rest(head):
        return native.bound_head().head_channels(
            performance,
            native.array(world.matrix(head)) @ object_from_character(scene, head),
            native.array(head.location),
            native.array(world.own_rotation(head)),
            head.rotation_mode,
            units_of(scene, head),
        )


def units_of(scene: bpy.types.Scene, head: bpy.types.Object) -> float:
    """Of the world, per metre of a head's motion: a face of our own mesh is built with a metre as a
    unit, whatever the scene's are, and moves as far as it was scaled; any other head is as large as
    the scene says."""
    if scene_in.is_face(head) and not len(head.mimetic.landmarks):
        return float(world.matrix(head).median_scale)
    return 1.0 / (scene.unit_settings.scale_length or 1.0)


def object_from_character(scene: bpy.types.Scene, head: bpy.types.Object):
    """4 x 4: a face of our own mesh lies in its object as the character frame does."""
    head_landmarks = heads.remembered_head(scene, head)
    if head_landmarks is None:
        return native.array(Matrix.Identity(4))
    parts = native.bound_head()
    return parts.object_from_character(
        head_landmarks.points, head_landmarks.landmarks, head_landmarks.matrix
    )


def shapes_for(performance, head: bpy.types.Object) -> list:
    """What a head's sliders play of a performance, `mimetic.character.shape.Shape`."""
    return native.shapes().slider_shapes_of(performance, by_hand.keys_now(head))


def sliders_of(head: bpy.types.Object, shapes: Sequence) -> dict[str, bpy.types.ShapeKey]:
    """The head's key for each shape that it has one for."""
    blocks = head.data.shape_keys.key_blocks
    names = {shape: state.key for shape, state in by_hand.look(head).items()}
    own = {shape.name: blocks.get(names.get(shape.name, shape.name)) for shape in shapes}
    return {name: key for name, key in own.items() if key is not None}


def no_play(head, shapes: Sequence, sliders: Mapping, driven_keys: set[str]) -> list[str]:
    """What of the shapes a head does not play, in sentences."""
    notes = []
    if missing := [shape.name for shape in shapes if shape.name not in sliders]:
        notes.append(
            iface_("{head} has no slider {names}").format(head=head.name, names=", ".join(missing))
        )
    driven_names = [key.name for key in sliders.values() if key.name in driven_keys]
    if remark := own_keys.driven_remark(head, driven_names):
        notes.append(remark)
    pairs = [(sliders[shape.name], shape) for shape in shapes if shape.name in sliders]
    if cut := [key.name for key, shape in pairs if _is_cut(key, shape.values)]:
        notes.append(
            iface_("{head} ends before the performance: the limits of {names}").format(
                head=head.name, names=", ".join(cut)
            )
        )
    return notes


def untouched_by(head: bpy.types.Object, names: set[str]) -> list[str]:
    return [
        entry.name
        for entry in head.mimetic.shapes
        if (entry.shape or entry.name) not in names and not _is_of_a_take(entry)
    ]


def _is_of_a_take(entry) -> bool:
    """Whether a shape belongs to one take, and is no slider for the hand."""
    parts = native.shapes()
    return entry.group in (parts.DETAIL, parts.CONTACT)


def _silence(head: bpy.types.Object, holder, shapes: Sequence) -> list[str]:
    """Puts to 0 what a take before gave a face of ours beyond what `shapes` play; its groups."""
    keys, played = head.data.shape_keys.key_blocks, {shape.name for shape in shapes}
    names, groups = by_hand.keys_now(head), []
    for shape, entry in by_hand.entries_of(head).items():
        is_stale = _is_of_a_take(entry) or (_turns_an_eye(shape) and shape not in played)
        if is_stale and (key := keys.get(names.get(shape, entry.name))):
            actions.clear(holder, key.path_from_id("value"))
            key.value = 0.0
            groups.append(entry.group.lower())
    return sorted(set(groups))


def _turns_an_eye(shape: str) -> bool:
    """Whether it is one of five that turn an eye together, each of no use by itself."""
    return shape[:-2] in gaze.TURNS


TOLERANCE = 1e-3  # of a slider


def _is_cut(key: bpy.types.ShapeKey, values) -> bool:
    return bool(
        values.min() < key.slider_min - TOLERANCE or values.max() > key.slider_max + TOLERANCE
    )
