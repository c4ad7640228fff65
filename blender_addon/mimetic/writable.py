# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be written to so that it is still there when the file is opened again.

Blender lets scripts write to linked data and forgets it on saving. A library override keeps curves
of its object and bones, and of its shape keys if the mesh is an override too, and the lists of
takes and controls; it never keeps points of a mesh, new shape keys, or what else we note on an
object. Functions say why not and the way out, or nothing.
"""

from __future__ import annotations

import bpy

from . import native

# Of properties that a library override keeps, and of lists that it adds rows to
KEPT = {"LIBRARY_OVERRIDABLE"}
KEPT_ROWS = {"LIBRARY_OVERRIDABLE", "USE_INSERTION"}
LOCAL = "make it local (Object > Relations > Make Local > Selected Objects and Data)"
OVERRIDE = "make a library override of it (Object > Library Override > Make)"
MESH_OVERRIDE = (
    "make a library override of the mesh too (Outliner: ID Data > Library Override > Make)"
)


def no_motion(obj: bpy.types.Object) -> str:
    """Why curves of an object or of its bones would be lost."""
    if obj.library:
        return f"{_linked(obj)}: {OVERRIDE}, or {LOCAL}"
    override = obj.override_library
    if override and override.is_system_override:
        return (
            f"{obj.name} is a library override that is not editable: make it editable "
            f"(Outliner, Library Overrides view), or {LOCAL}"
        )
    return ""


def no_sliders(face: bpy.types.Object) -> str:
    """Why values and curves of a mesh's shape keys would be lost."""
    if face.library:
        return f"{_linked(face)}, its sliders with it: {LOCAL}"
    if face.data.library:
        way = f"{MESH_OVERRIDE}, or {LOCAL}" if face.override_library else LOCAL
        return f"{_linked(face.data, face)}, its sliders with it: {way}"
    return no_motion(face)


def no_shapes(face: bpy.types.Object) -> str:
    """Why points and new shape keys of a mesh would be lost."""
    if reason := no_sliders(face):
        return reason
    if face.override_library or face.data.override_library:
        return f"{face.name} is a library override, which keeps no shapes of its own: {LOCAL}"
    return ""


def no_lens(camera: bpy.types.Object) -> str:
    """Why a camera's lens and background would be lost."""
    for block in (camera, camera.data):
        if block.library:
            return f"{_linked(block, camera)}: {LOCAL}"
    return ""


def no_tracks(clip: bpy.types.MovieClip) -> str:
    """Why tracks and stabilisation of a clip would be lost."""
    if clip.library:
        return f"{_linked(clip)}: make it local (Outliner, Blender File view: ID Data > Make Local)"
    return ""


def own_object(scene: bpy.types.Scene, name: str) -> bpy.types.Object:
    """An object of this file by its name, which an override shares with what it overrides; else
    whatever the scene has."""
    own = bpy.data.objects.get((name, None))
    return own if own is not None and own.name in scene.objects else scene.objects[name]


def check(reason: str) -> None:
    """Raises InvalidInput with the reason, if there is one."""
    if reason:
        raise native.invalid_input(reason)


def _linked(block: bpy.types.ID, owner: bpy.types.Object | None = None) -> str:
    what = block.name if owner in (None, block) else f"{block.bl_rna.name} of {owner.name}"
    return f"{what} is linked from {bpy.path.basename(block.library.filepath)}"
