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
    if evaluated_object.is_evaluated:
        return evaluated_object.matrix_world.copy()
    # Switched off in the view layer, where nothing is evaluated: as it stands by itself
    in_parent = obj.matrix_parent_inverse @ obj.matrix_basis
    return matrix(obj.parent) @ in_parent if obj.parent else in_parent


def space(obj: bpy.types.Object) -> Matrix:
    """World from the space of the object's own curves, its parent's, as of now."""
    return matrix(obj) @ obj.matrix_basis.inverted_safe()
