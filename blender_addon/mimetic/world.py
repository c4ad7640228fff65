# SPDX-License-Identifier: GPL-3.0-or-later
"""Where objects stand in the world.

Blender's own `matrix_world` is of the last evaluation: none has been yet where an object was just
made or moved, nor after an undo, and the redo panel undoes and runs an operator at once.
"""

from __future__ import annotations

import bpy
from mathutils import Matrix


def matrix(shown: bpy.types.Object) -> Matrix:
    """World from object, as of now; evaluates what is shown if need be."""
    evaluated = shown.evaluated_get(bpy.context.evaluated_depsgraph_get())
    if evaluated.is_evaluated:
        return evaluated.matrix_world.copy()
    # Switched off in the view layer, where nothing is evaluated: as it stands by itself
    in_parent = shown.matrix_parent_inverse @ shown.matrix_basis
    return matrix(shown.parent) @ in_parent if shown.parent else in_parent
