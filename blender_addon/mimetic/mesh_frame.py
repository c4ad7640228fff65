# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame in which something was noted of a mesh: Blender's Apply gives all of its points other
coordinates, and Edit Mode takes some away or adds some."""

from __future__ import annotations

import bpy
import numpy as np
from bpy.props import FloatVectorProperty, IntProperty, IntVectorProperty
from mathutils import Matrix

from . import native

NUM_MARKS = 8  # four would do; more of them average what rounding adds


class MimeticMeshFrame(bpy.types.PropertyGroup):
    """A mesh as it was when something was noted in its own frame: some of its vertices."""

    num_vertices: IntProperty(description="Of the whole mesh; 0 where nothing was noted")
    marks: IntVectorProperty(size=NUM_MARKS, description="Vertices that lie far from each other")
    places: FloatVectorProperty(
        size=3 * NUM_MARKS, precision=6, description="Where these were in the mesh's own frame"
    )


def note(frame: MimeticMeshFrame, points: np.ndarray) -> None:
    """From here on what is noted is in the frame of these points, V x 3, the mesh at rest."""
    frame.num_vertices = len(points)
    if len(points):
        marks = native.core().marks_of(points, NUM_MARKS)
        frame.marks = marks
        frame.places = np.asarray(points)[marks].ravel().tolist()


def is_cut(frame: MimeticMeshFrame, obj: bpy.types.Object) -> bool:
    """Whether the mesh has other vertices than those that were noted."""
    return frame.num_vertices not in (0, len(obj.data.vertices))


def now_from_noted(frame: MimeticMeshFrame, obj: bpy.types.Object) -> np.ndarray:
    """4 x 4; the identity, too, where it cannot be known."""
    if frame.num_vertices == 0 or is_cut(frame, obj):
        return np.eye(4)
    mesh = obj.data
    vertices = mesh.shape_keys.reference_key.points if mesh.shape_keys else mesh.vertices
    now = np.array([vertices[mark].co for mark in frame.marks], dtype=np.float64)
    noted = np.array(frame.places, dtype=np.float64).reshape(-1, 3)
    return native.core().now_from_noted(noted, now)


def noted_from_now(frame: MimeticMeshFrame, obj: bpy.types.Object) -> np.ndarray:
    return native.array(Matrix(now_from_noted(frame, obj).tolist()).inverted())


CLASSES = (MimeticMeshFrame,)
