# SPDX-License-Identifier: GPL-3.0-or-later
"""Eyeballs of a character's head as objects that turn, whether they were part of its mesh or
objects of their own. Changes the character for good: for a copy of its file."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix

from .. import head_parts, heads, native, scene_in, world
from . import actions, arkit_target, bound, contact, eye_nodes, rigs

EVEN = 1e-3  # by how much an object's scales may differ
STILL = 1e-5  # of the mesh's extent: a key that moves less moves nothing


def no_eyes(performance, head: bpy.types.Object) -> str:
    """Why a head's eyeballs cannot turn by a performance, or nothing."""
    if head.type != "MESH" or not scene_in.is_face(head):
        return rpt_(
            "{name} has no muscles, so its eyeballs are not known: attach muscles to the mesh of "
            "the head and give that, or leave --eyes out"
        ).format(name=head.name)
    if not native.gaze_shapes().has_gaze(performance):
        return rpt_(
            "the performance has no gaze to turn eyes by: capture the clip again, or leave "
            "--eyes out"
        )
    scales = np.array(world.matrix(head).to_scale())
    if world.matrix(head).determinant() < 0 or np.ptp(scales) > EVEN * scales.max():
        return rpt_(
            "{name} is mirrored or not scaled alike along x, y and z, which a turning eye cannot "
            "be: apply its scale (Ctrl A) and attach its muscles again, or leave --eyes out"
        ).format(name=head.name)
    rig = _rig_of(head)
    if rig is not None and not rigs.head_bones(rig).head:
        return rpt_("{remark}: its bone carries the eyes; or leave --eyes out").format(
            remark=rigs.head_bones(rig).remark
        )
    return ""


class BoundEyes:
    """The eyeballs that a head has, found before its muscles' keys go."""

    def __init__(self, scene: bpy.types.Scene, head: bpy.types.Object) -> None:
        own = heads.bound_head(scene, head)
        face = native.foreign_face().attach_face(*own.whole, own.landmarks, own.matrix)
        self._head, self._rig = head, _rig_of(head)
        self._object_from_character = bound.object_from_character(scene, head)
        self._pivots = face.eye_centers
        first = len(own.points)
        self._holders = [(head, Matrix.Identity(4), face.head.eye_of_vertex[:first])]
        for part in own.parts:
            last = first + len(part.mesh.points)
            obj, eye_of = head_parts.object_of(part), face.head.eye_of_vertex[first:last]
            if obj is not None:
                self._holders.append((obj, Matrix(part.mesh.head_from_part.tolist()), eye_of))
            first = last
        if not any(eye_of.any() for _, _, eye_of in self._holders):
            raise native.invalid_input(
                rpt_(
                    "{name} has no eyeballs, in its mesh or as objects of their own that its "
                    "muscles were attached with: leave --eyes out"
                ).format(name=head.name)
            )

    def split(self, scene: bpy.types.Scene, performance, footage, take: str) -> list[str]:
        """Makes the eyeballs objects with curves of their turns, and takes them off what held them;
        returns the names of the objects."""
        frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
        package = native.gaze_shapes()
        angles = package.gaze_of(performance)
        names = []
        for number, name in enumerate(eye_nodes.NAMES):
            pieces = self._pieces(number, name)
            if not pieces:
                continue
            eye, *others = pieces
            self._hang(eye, self._pivots[number])
            for other in others:
                other.parent = eye
            yaw, pitch = angles[:, 2 * number], angles[:, 2 * number + 1]
            rows = package.eye_quaternions(yaw, pitch, self._object_from_character)
            eye.rotation_mode = "QUATERNION"
            holder = actions.new_take(eye, f"{take} {name}")
            actions.key_columns(holder, "rotation_quaternion", "Gaze", frames, rows)
            names.append(eye.name)
        for obj, _, eye_of in self._holders:
            if eye_of.any():
                self._empty(obj, eye_of)
        bpy.context.view_layer.update()
        return names

    def _pieces(self, number: int, name: str) -> list[bpy.types.Object]:
        """The parts of an eyeball, one of each mesh that holds any, about its middle."""
        pieces = []
        for obj, head_from_obj, eye_of in self._holders:
            is_own = eye_of == number + 1
            if not is_own.any():
                continue
            piece = bpy.data.objects.new(name, obj.data.copy())
            self._head.users_collection[0].objects.link(piece)
            for before, now in zip(obj.material_slots, piece.material_slots, strict=True):
                now.link, now.material = before.link, before.material
            piece.shape_key_clear()
            eye_nodes.keep(piece.data, is_own)
            middle = Matrix.Translation([-float(x) for x in self._pivots[number]])
            piece.data.transform(middle @ head_from_obj)
            pieces.append(piece)
        return pieces

    def _hang(self, eye: bpy.types.Object, pivot) -> None:
        """Below the head, or the head's bone of the rig that deforms it: skins carry no nodes."""
        head, rig = self._head, self._rig
        eye.parent = head
        if rig is not None:
            bone = rig.data.bones[rigs.head_bones(rig).head]
            eye.parent, eye.parent_type, eye.parent_bone = rig, "BONE", bone.name
            tail = bone.matrix_local @ Matrix.Translation((0, bone.length, 0))
            rest = world.matrix(rig) @ tail
            eye.matrix_parent_inverse = rest.inverted() @ world.matrix(head)
        eye.location = [float(x) for x in pivot]

    def _empty(self, obj: bpy.types.Object, eye_of: np.ndarray) -> None:
        """Takes the eyeballs off a mesh, and the keys that moved nothing else."""
        if obj != self._head and eye_of.all():
            for child in obj.children:
                child.parent = self._head
            bpy.data.objects.remove(obj)
            return
        moved = set(_moving_keys(obj))
        eye_nodes.keep(obj.data, eye_of == 0)
        arkit_target.drop(obj, moved - set(_moving_keys(obj)) - _kept_names())


def _kept_names() -> set[str]:
    """Names that readers of ARKit's shapes count on."""
    return set(native.unit_fit().unit_order())


def _moving_keys(obj: bpy.types.Object) -> list[str]:
    keys = obj.data.shape_keys
    if keys is None:
        return []
    rest = contact.points_of(keys.reference_key)
    least = STILL * float(np.ptp(rest, axis=0).max(initial=0.0))
    return [
        key.name
        for key in keys.key_blocks
        if np.abs(contact.points_of(key) - rest).max(initial=0.0) > least
    ]


def _rig_of(head: bpy.types.Object) -> bpy.types.Object | None:
    """The armature that deforms a head."""
    return next((m.object for m in head.modifiers if m.type == "ARMATURE" and m.object), None)
