# SPDX-License-Identifier: GPL-3.0-or-later
"""What may be written to so that it is still there when the file is opened again.

Blender lets scripts write to linked data and forgets it on saving. A library override keeps curves
of its object and bones, and of its shape keys if the mesh is an override too, and the lists of
takes and controls; it never keeps points of a mesh, new shape keys, or what else we note on an
object. Functions say why not and the way out, or nothing.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

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
        return iface_("{linked}: {way}, or {other}").format(
            linked=_linked(obj), way=iface_(OVERRIDE), other=iface_(LOCAL)
        )
    override = obj.override_library
    if override and override.is_system_override:
        return iface_(
            "{name} is a library override that is not editable: make it "
            "editable (Outliner, Library Overrides view), or {way}"
        ).format(name=obj.name, way=iface_(LOCAL))
    return ""


def no_sliders(face: bpy.types.Object) -> str:
    """Why values and curves of a mesh's shape keys would be lost."""
    if face.library:
        return iface_("{linked}, its sliders with it: {way}").format(
            linked=_linked(face), way=LOCAL
        )
    if face.data.library:
        way = iface_(LOCAL)
        if face.override_library:
            way = iface_("{way}, or {other}").format(way=iface_(MESH_OVERRIDE), other=way)
        return iface_("{linked}, its sliders with it: {way}").format(
            linked=_linked(face.data, face), way=way
        )
    return no_motion(face)


def no_shapes(face: bpy.types.Object) -> str:
    """Why points and new shape keys of a mesh would be lost."""
    if reason := no_sliders(face):
        return reason
    if face.override_library or face.data.override_library:
        return iface_(
            "{name} is a library override, which keeps no shapes of its own: {way}"
        ).format(name=face.name, way=iface_(LOCAL))
    return ""


def no_own_mesh(obj: bpy.types.Object) -> str:
    """Why what is done to a mesh would be done to other objects too."""
    sharing = obj.data.users - obj.data.use_fake_user
    if sharing <= 1:
        return ""
    return iface_(
        "{name} shares its mesh with {count} more: make it its own (Object "
        "> Relations > Make Single User > Object & Data)"
    ).format(name=obj.name, count=sharing - 1)


def no_lens(camera: bpy.types.Object) -> str:
    """Why a camera's lens and background would be lost."""
    for block in (camera, camera.data):
        if block.library:
            return f"{_linked(block, camera)}: {iface_(LOCAL)}"
    return ""


def no_tracks(clip: bpy.types.MovieClip) -> str:
    """Why tracks and stabilisation of a clip would be lost."""
    return _no_local(clip)


def no_objects(scene: bpy.types.Scene) -> str:
    """Why a scene takes no new objects."""
    return _no_local(scene)


def collections_for(
    scene: bpy.types.Scene, wished: Iterable[bpy.types.Collection]
) -> list[bpy.types.Collection]:
    """Where a scene's new objects go: into those collections that take any, else into its own.
    Linked ones and overrides take none."""
    own = [collection for collection in wished if not _is_foreign(collection)]
    return own or [scene.collection]


def own_object(scene: bpy.types.Scene, name: str) -> bpy.types.Object:
    """An object of this file by its name, which an override shares with what it overrides; else
    whatever the scene has. Raises InvalidInput where that is nothing by now."""
    own = bpy.data.objects.get((name, None))
    found = own if own in scene.objects.values() else scene.objects.get(name)
    if found is None:
        raise native.invalid_input(
            rpt_("{head} was deleted or renamed meanwhile: begin again").format(head=name)
        )
    return found


def check(reason: str) -> None:
    """Raises InvalidInput with the reason, if there is one."""
    if reason:
        raise native.invalid_input(reason)


def _is_foreign(collection: bpy.types.Collection) -> bool:
    return bool(collection.library or collection.override_library)


def _no_local(block: bpy.types.ID) -> str:
    """Why what is written to a block would be lost where it is another file's."""
    if not block.library:
        return ""
    return iface_(
        "{linked}: make it local (Outliner, Blender File view: ID Data > Make Local)"
    ).format(linked=_linked(block))


def _linked(block: bpy.types.ID, owner: bpy.types.Object | None = None) -> str:
    what = block.name
    if owner not in (None, block):
        what = iface_("{kind} of {owner}").format(kind=iface_(block.bl_rna.name), owner=owner.name)
    return iface_("{name} is linked from {file}").format(
        name=what, file=bpy.path.basename(block.library.filepath)
    )
