# SPDX-License-Identifier: GPL-3.0-or-later
"""Where objects stand in the world.

Blender's own `matrix_world` is of the last evaluation: none has been yet where an object was just
made or moved, nor after an undo, and the redo panel undoes and runs an operator at once.
"""

from __future__ import annotations

import bpy
from mathutils import Matrix


def own_rotation(obj: bpy.types.Object) -> Matrix:
    """The object's own rotation; a decomposed matrix gives another where the scale mirrors."""
    if obj.rotation_mode == "QUATERNION":
        return obj.rotation_quaternion.to_matrix()
    if obj.rotation_mode == "AXIS_ANGLE":
        angle, *axis = obj.rotation_axis_angle
        return Matrix.Rotation(angle, 3, axis)
    return obj.rotation_euler.to_matrix()


def matrix(obj: bpy.types.Object) -> Matrix:
    """World from object, as of now; evaluates what is shown if need be."""
    evaluated_object = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    # One that is switched off says that it is evaluated where a property names it, and may stand
    # as it did when it was shown last, or nowhere since the file was opened
    if evaluated_object.is_evaluated and (obj.visible_get() or _follows_more(obj)):
        return evaluated_object.matrix_world.copy()
    in_parent = obj.matrix_parent_inverse @ obj.matrix_basis
    return matrix(obj.parent) @ in_parent if obj.parent else in_parent


def _follows_more(obj: bpy.types.Object) -> bool:
    """Whether more than its own values and its parent places an object, as only Blender knows."""
    if obj.parent and (obj.parent_type not in ("OBJECT", "ARMATURE") or obj.parent.type == "CURVE"):
        return True
    deltas = Matrix.LocRotScale(
        obj.delta_location,
        obj.delta_rotation_quaternion
        if obj.rotation_mode == "QUATERNION"
        else obj.delta_rotation_euler,
        obj.delta_scale,
    )
    return bool(obj.constraints or obj.rigid_body) or deltas != Matrix.Identity(4)


def space(obj: bpy.types.Object) -> Matrix:
    """World from the space of the object's own curves, its parent's, as of now."""
    return matrix(obj) @ obj.matrix_basis.inverted_safe()
