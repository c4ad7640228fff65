# SPDX-License-Identifier: GPL-3.0-or-later
"""The face: an object with a shape key for every muscle, for jaw and lids, and for detail.

Shape keys of whole groups come last. Their values add to those of the muscles, so that a slider
of a group and a baked curve of a muscle never write to the same place. What was changed by hand on
a face that is written again stays.
"""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from .. import mesh_frame, native, scene_in, writable
from . import actions, by_hand, contact, gaze, renamed_keys
from .by_hand import HandChanges, KeyState

BASIS = "Basis"


def ensure(
    scene, performance, shapes, groups, subdivision: int, is_reset: bool = False
) -> tuple[bpy.types.Object, HandChanges]:
    """The face of the performance's footage; a new one if there is none, or its topology differs.

    A performance that does not say what it is of has the scene's face. is_reset: changes made by
    hand go. Tells, too, what was kept of them.
    """
    face = find(scene, performance)
    if face is None:
        face = new(performance.neutral_vertices, performance.faces)
        scene.collection.objects.link(face)
    if performance.footage:
        face.mimetic.footage = performance.footage[1]
    scene.mimetic.face = face
    gaze.remember(face, performance)
    hand_changes = set_shapes(face, performance.neutral_vertices, shapes, groups, is_reset)
    if subdivide(face, subdivision, is_reset):
        hand_changes.things.append(iface_("the subdivision"))
    return face, hand_changes


def find(scene, performance) -> bpy.types.Object | None:
    """The face that a performance goes on: of its footage, and of its topology."""
    face = _face_of(scene, performance.footage[1] if performance.footage else "")
    return face if scene_in.holds(scene, face) and _has_faces(face, performance.faces) else None


def passed_over(scene, performance) -> bpy.types.Object | None:
    """The face of the performance's footage that `find` does not give, unless it was deleted."""
    face = _face_of(scene, performance.footage[1] if performance.footage else "")
    if face is None or face == find(scene, performance):
        return None
    return face if face.users_collection else None  # the scene goes on referring to a deleted one


def second_remark(scene, face: bpy.types.Object, other: bpy.types.Object | None) -> str:
    """That `face` was made although there is another one of its footage, or nothing."""
    if other is None:
        return ""
    if scene_in.holds(scene, other):
        text = rpt_(
            "{other} has other vertices than were baked: {face} is new, and {other} stays as it "
            "is; hide or delete one"
        )
    else:
        text = rpt_(
            "{other} is in no collection of the scene: {face} is new, and {other} stays as it is; "
            "hide or delete one"
        )
    return text.format(other=other.name, face=face.name)


def _face_of(scene, mark: str) -> bpy.types.Object | None:
    """The scene's face if it may be that of the footage with a fingerprint, or another that is:
    the active one first, as a face that was duplicated is of the footage twice."""
    current = scene.mimetic.face
    if not mark or (current is not None and current.mimetic.footage in ("", mark)):
        return current
    others = [obj for obj in scene.objects if obj.mimetic.footage == mark]
    others.sort(key=lambda obj: obj != bpy.context.view_layer.objects.active)
    return next((o for o in others if o.mode != "EDIT" and not writable.no_shapes(o)), None)


def _has_faces(face, faces) -> bool:
    mesh = face.data
    if face.type != "MESH" or len(mesh.loops) != faces.size:
        return False
    corners = np.empty(faces.size, dtype=np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    return bool((corners == faces.reshape(-1)).all())


def new(neutral_vertices, faces) -> bpy.types.Object:
    """A face without shapes, in no collection yet; V x 3 metres in the head frame, F x 4."""
    mesh = bpy.data.meshes.new("Face")
    vertices = native.placement().to_object(neutral_vertices)
    mesh.from_pydata(vertices, [], faces.tolist())
    mesh.shade_smooth()
    face = bpy.data.objects.new("Face", mesh)
    face.rotation_mode = "QUATERNION"
    return face


def set_shapes(face, neutral_vertices, shapes, groups, is_reset: bool = False) -> HandChanges:
    """Gives the face its shape keys, `mimetic.shapes.Shape`: shapes, then sliders of groups.

    Keys of before that are not among them go. What was changed by hand stays, and so do keys that
    the face was not given here, unless `is_reset`.
    """
    keys = face.data.shape_keys
    if keys is None:
        face.shape_key_add(name=BASIS, from_mix=False)
        keys = face.data.shape_keys
        keys.name = "Face"
    states = by_hand.look(face)
    if is_reset:
        states = _take_names_back(face, states)
    renamed_keys.follow(face)  # while the names of before are known
    hand_changes = HandChanges()
    names = {shape.name for shape in (*shapes, *groups)}
    left = _drop_others(face, states, names, hand_changes)
    shift = _set_rest(face, neutral_vertices, is_reset, hand_changes)
    _add_missing(face, states, shapes, groups)
    for name in left:  # only now: to add keys evaluates curves of before
        keys.key_blocks[name].value = 0.0
    entries = list_shapes(face.mimetic.shapes, shapes), list_shapes(face.mimetic.groups, groups)
    new_keys = set()
    for of_kind, new_shapes in zip(entries, (shapes, groups), strict=True):
        for entry, shape in zip(of_kind, new_shapes, strict=True):
            new_keys |= write_key(face, entry, shape, states[shape.name], hand_changes)
    if shift.any():  # other keys go along with the rest, as when it is sculpted
        for key in keys.key_blocks:
            if key != keys.reference_key and key.name not in new_keys:
                place_key(key, contact.points_of(key) + shift)
    if face.mimetic.use_contact:
        contact.ensure_key(face)
        contact.rest(face)
    by_hand.remember_places(face)
    face.data.update()
    return hand_changes


def key_names(face) -> dict[str, str]:
    """The name that each shape's key has on the face."""
    return {shape: entry.name for shape, entry in by_hand.entries_of(face).items()}


def _take_names_back(face, states: dict[str, KeyState]) -> dict[str, KeyState]:
    keys = {shape: face.data.shape_keys.key_blocks[state.key] for shape, state in states.items()}
    for shape, key in keys.items():
        key.name = shape
    return {shape: KeyState(key.name) for shape, key in keys.items()}


def _drop_others(
    face, states: dict[str, KeyState], names: set[str], hand_changes: HandChanges
) -> list[str]:
    """Removes what an earlier take moved and this one does not; returns keys that must stay."""
    left = []
    keys = face.data.shape_keys
    animation = keys.animation_data
    driven_paths = actions.driver_paths(keys)
    in_strips = animation is not None and len(animation.nla_tracks) > 0
    for shape in [shape for shape in states if shape not in names]:
        key = keys.key_blocks[states[shape].key]
        if in_strips or states[shape].is_changed() or key.path_from_id("value") in driven_paths:
            left.append(key.name)
            hand_changes.add(shape, states[shape])
        else:
            face.shape_key_remove(key)
    return left


def _set_rest(face, neutral_vertices, is_reset: bool, hand_changes: HandChanges) -> np.ndarray:
    """Puts the basis where the face rests unless it was sculpted; V x 3 by how much it moved."""
    neutral = native.placement().to_object(neutral_vertices).astype(np.float32)
    basis = face.data.shape_keys.reference_key
    shift = neutral - contact.points_of(basis)
    is_sculpted = not is_reset and by_hand.is_rest_sculpted(face)
    if is_sculpted and shift.any():
        hand_changes.things.append(iface_("the face at rest"))
        shift = np.zeros_like(neutral)
    else:
        place_key(basis, neutral)
        # The mesh's own vertices follow its first key; foreach_set on keys alone leaves them behind
        face.data.vertices.foreach_set("co", neutral.reshape(-1))
    mesh_frame.note(face.mimetic.mesh_frame, contact.points_of(basis))
    by_hand.remember(face.mimetic.rest, basis, neutral, np.zeros_like(neutral), 0.0, 0.0)
    return shift


def _add_missing(face, states: dict[str, KeyState], shapes, groups) -> None:
    """Adds keys; those of groups and contact stay behind all others. Completes `states`."""
    blocks = face.data.shape_keys.key_blocks
    num_before = len(blocks)
    for shape in (*shapes, *groups):
        if shape.name in states:
            continue
        if shape.name in blocks:  # of the user's own making: as one that was sculpted
            states[shape.name] = KeyState(shape.name, is_sculpted=True, has_own_limits=True)
            continue
        add_key(face, shape.name)
        states[shape.name] = KeyState(shape.name)
    last = [states[group.name].key for group in groups] + [contact.KEY]
    if len(blocks) > num_before:
        move_to_end(face, [name for name in last if name in blocks])


def add_key(obj, name: str) -> bpy.types.ShapeKey:
    """A new key of an object that has some, at rest."""
    key = obj.shape_key_add(name=name, from_mix=False)
    key.relative_key = obj.data.shape_keys.reference_key
    key.value = 0.0  # Blender 5.2 starts at 1
    return key


def move_to_end(face, names: list[str]) -> None:
    """Puts shape keys behind all others, in this order."""
    blocks = face.data.shape_keys.key_blocks
    if [key.name for key in blocks[len(blocks) - len(names) :]] == names:
        return
    active = face.active_shape_key.name if face.active_shape_key else ""
    with bpy.context.temp_override(object=face, active_object=face):
        for name in names:
            face.active_shape_key_index = blocks.find(name)
            bpy.ops.object.shape_key_move(type="BOTTOM")
    face.active_shape_key_index = max(blocks.find(active), 0)


def write_key(face, entry, shape, state: KeyState, hand_changes: HandChanges) -> set[str]:
    """Gives a shape's key points and limits; returns the key's name if it has new points."""
    keys = face.data.shape_keys
    key, basis = keys.key_blocks[state.key], contact.points_of(keys.reference_key)
    offsets = native.placement().to_object(shape.offsets)
    points = (basis + offsets).astype(np.float32)
    by_hand.remember(entry, key, basis, offsets, shape.lowest, shape.highest)
    limits = np.subtract((key.slider_min, key.slider_max), (shape.lowest, shape.highest))
    state = KeyState(
        state.key,
        state.is_renamed,
        state.is_sculpted and not np.allclose(contact.points_of(key), points, atol=1e-7),
        state.has_own_limits and np.abs(limits).max() > by_hand.NEAR,
    )
    hand_changes.add(shape.name, state)
    if not state.has_own_limits:
        key.slider_min = min(key.slider_min, shape.lowest)  # limits may not cross on the way
        key.slider_max, key.slider_min = shape.highest, shape.lowest
        key.value = key.value  # within them
    if state.is_sculpted:
        return set()
    key.relative_key = keys.reference_key
    place_key(key, points)
    return {key.name}


def list_shapes(entries, shapes):
    """Makes a face's list that of these shapes, and returns it."""
    entries.clear()
    for shape in shapes:
        entry = entries.add()
        entry.name = entry.shape = shape.name
        entry.group = shape.group
    return entries


def place_key(key, points) -> None:
    key.points.foreach_set("co", points.astype(np.float32).reshape(-1))


def subdivide(face, levels: int, is_reset: bool = False) -> bool:
    """Subdivides the surface as it is shown; says whether levels chosen by hand were kept."""
    modifier = next((m for m in face.modifiers if m.type == "SUBSURF"), None)
    target = (levels, max(levels, min(levels + 1, 2))) if levels or modifier else (0, 0)
    current = (modifier.levels, modifier.render_levels) if modifier else (0, 0)
    levels_before = tuple(face.mimetic.subdivision)
    face.mimetic.subdivision = target
    if current == target:
        return False
    if not is_reset and levels_before not in ((-1, -1), current):
        return True
    if modifier is None:
        modifier = face.modifiers.new("Subdivision", "SUBSURF")
        modifier.boundary_smooth = "PRESERVE_CORNERS"
    modifier.levels, modifier.render_levels = target
    return False
