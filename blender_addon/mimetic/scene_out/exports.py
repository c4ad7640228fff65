# SPDX-License-Identifier: GPL-3.0-or-later
"""A face or character for other programs, by Blender's own exporters, and what each loses."""

from __future__ import annotations

import math
import os
import struct
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_

from .. import compat, native
from . import (
    contact_curves,
    exporter_reports,
    gltf,
    negative_keys,
    part_curves,
    pictures,
    selection,
    strip_curves,
)

# How a USD crate file begins: its kind, 8 bytes of version, and where its table of contents is
CRATE_HEADER = struct.Struct("<8s8xq")
CRATE_SECTION = 32  # bytes of a row of that table, which the number of rows precedes


def _is_anything(path: Path) -> bool:
    return path.stat().st_size > 0


def _is_whole_usd(path: Path) -> bool:
    """Whether all of a crate file is there: its table of contents is written last."""
    size = path.stat().st_size
    with open(path, "rb") as stream:
        header = stream.read(CRATE_HEADER.size)
        if len(header) < CRATE_HEADER.size:
            return False
        kind, contents = CRATE_HEADER.unpack(header)
        if kind != b"PXR-USDC" or not CRATE_HEADER.size <= contents <= size - 8:
            return False
        stream.seek(contents)
        (num_sections,) = struct.unpack("<Q", stream.read(8))
    return contents + 8 + CRATE_SECTION * num_sections <= size


@dataclass(frozen=True)
class Format:
    name: str
    is_built: Callable[[], bool]  # whether this Blender has its exporter
    write: Callable[[str, int, int], None]  # the selected objects; first and last frame
    loses: str  # for the user
    pictures: str = ""  # "inside" the file, "beside" it in a folder, or none
    subdivides: bool = False  # whether it says itself that a mesh is to be subdivided
    # Whether its exporter writes the scene's own range, which no scene has before frame 0
    begins_at_0: bool = True
    # Whether a file is not cut off: of an exporter that does not report a full disk
    is_whole: Callable[[Path], bool] = _is_anything


def _fbx(path: str, first: int, last: int) -> None:
    bpy.ops.export_scene.fbx(
        filepath=path,
        check_existing=False,
        use_selection=True,
        object_types={"MESH", "ARMATURE", "EMPTY"},
        path_mode="COPY",
        embed_textures=True,
        use_mesh_modifiers=False,
        mesh_smooth_type="FACE",
        add_leaf_bones=False,
        use_armature_deform_only=True,
        bake_anim=True,
        bake_anim_use_all_bones=True,
        bake_anim_use_nla_strips=False,
        bake_anim_use_all_actions=False,
        bake_anim_force_startend_keying=True,
        bake_anim_simplify_factor=0.0,
    )


def _usd(path: str, first: int, last: int) -> None:
    bpy.ops.wm.usd_export(
        filepath=path,
        check_existing=False,
        selected_objects_only=True,
        export_animation=True,
        export_shapekeys=True,
        export_armatures=True,
        only_deform_bones=True,
        export_subdivision="BEST_MATCH",
        evaluation_mode="VIEWPORT",
        convert_world_material=False,
        relative_paths=True,
        **compat.usd_textures_stay(),
    )


def _alembic(path: str, first: int, last: int) -> None:
    bpy.ops.wm.alembic_export(
        filepath=path,
        check_existing=False,
        as_background_job=False,
        selected=True,
        start=first,
        end=last,
        evaluation_mode="VIEWPORT",
    )


FORMATS = {
    ".fbx": Format(
        "FBX",
        lambda: "fbx" in dir(bpy.ops.export_scene),
        _fbx,
        "weights are keyed every frame as percent, turns as Euler angles; limits of sliders and "
        "subdivision are lost",
        "inside",
    ),
    ".usdc": Format(
        "USD",
        lambda: bpy.app.build_options.usd,
        _usd,
        "blend shapes' names have _ for every dot and space; limits of sliders are lost",
        "beside",
        subdivides=True,
        is_whole=_is_whole_usd,  # a full disk is on the console alone, and FINISHED is returned
    ),
    ".abc": Format(
        "Alembic",
        lambda: bpy.app.build_options.alembic,
        _alembic,
        "every frame's vertices without shape keys, materials and pictures: nothing can be edited",
        begins_at_0=False,
    ),
}


def no_format(suffix: str) -> str:
    """Why a file of this kind cannot be written, or nothing."""
    if suffix not in FORMATS:
        return iface_("{suffix}: files are written as {formats}").format(
            suffix=suffix or iface_("no suffix"), formats=", ".join(FORMATS)
        )
    kind = FORMATS[suffix]
    if kind.is_built():
        return ""
    return iface_(
        "This Blender has no {format} exporter: enable its add-on, or take another build"
    ).format(format=kind.name)


def write(scene: bpy.types.Scene, path: str | os.PathLike[str], character) -> str:
    """The same as `export`, and glTF too."""
    if Path(path).suffix != ".glb":
        return export(scene, path, character)
    return gltf.export(scene, path, character)


def export(
    scene: bpy.types.Scene, path: str | os.PathLike[str], character: bpy.types.Object
) -> str:
    """Writes a face, or a character with its rig, whole or not at all; says what the format loses,
    and what is hidden.

    The file has the frames of the character's curves, the scene's range where it has none; those
    before frame 0 that the format's exporter cannot write are said. The scene stays as it is.
    Raises what bad input raises where this Blender cannot write it, the character is hidden or all
    of its motion is before frame 0, and OSError.
    """
    path = Path(path)
    if reason := no_format(path.suffix):
        raise native.invalid_input(reason)
    kind = FORMATS[path.suffix]
    with selection.scene_at_hand(scene):
        objects = selection.character_objects(scene, character)
        cut = _write(scene, path, character, objects, kind)
        left_out = selection.left_out(scene, character)
    return "; ".join(filter(None, (cut, f"{kind.name}: {rpt_(kind.loses)}", left_out)))


def _write(
    scene: bpy.types.Scene,
    path: Path,
    character: bpy.types.Object,
    objects: list[bpy.types.Object],
    kind: Format,
) -> str:
    """Returns which frames were left out, or nothing."""
    files = native.whole_file()
    with files.file_with_textures(path) as aside:
        # What is not named after the file goes with the folder
        folder = aside.name + files.TEXTURES if kind.pictures == "beside" else "embedded"
        shaped = selection.with_shape_keys(objects)
        with ExitStack() as stack:
            stack.enter_context(selection.selected_alone(objects, character))
            stack.enter_context(strip_curves.with_curves(scene, objects))
            for obj in selection.one_a_mesh(shaped):
                stack.enter_context(contact_curves.with_keys(scene, obj))
            stack.enter_context(part_curves.with_curves(shaped))
            stack.enter_context(negative_keys.split(shaped))
            stack.enter_context(_unsubdivided(objects, kind.subdivides))
            if kind.pictures:
                stack.enter_context(pictures.as_files(objects, aside.with_name(folder)))
            first, last = stack.enter_context(_whole_range(scene, objects))
            cut = _before_0(first, last, kind)
            try:
                kind.write(str(aside), first, last)
            except RuntimeError as error:  # what the exporter reported
                raise exporter_reports.reported(error, path) from None
        _check_written(aside, path, kind)
    return cut


def _before_0(first: int, last: int, kind: Format) -> str:
    """What to say of frames that an exporter leaves out, or nothing; raises what bad input raises
    where it is all."""
    if first >= 0 or not kind.begins_at_0:
        return ""
    if last < 0:
        raise native.invalid_input(
            rpt_(
                "all motion is before frame 0, where Blender's {format} exporter begins: move it "
                "by {count} frames or more (Retime, Later)"
            ).format(format=kind.name, count=-first)
        )
    return rpt_(
        "frames {first} to -1 are left out, as Blender's {format} exporter begins at frame 0: to "
        "have them, move the motion by {count} frames or more (Retime, Later)"
    ).format(first=first, format=kind.name, count=-first)


def _check_written(aside: Path, path: Path, kind: Format) -> None:
    """Raises OSError unless the exporter wrote a whole file, which is to be `path`, at `aside`."""
    if not aside.is_file():
        raise OSError(
            rpt_("{path}: Blender's {format} exporter wrote nothing").format(
                path=path, format=kind.name
            )
        )
    if not kind.is_whole(aside):
        raise OSError(
            rpt_(
                "{path}: Blender's {format} exporter wrote a part of the file alone: probably no "
                "space is left on the disk; free some, or choose another folder"
            ).format(path=path, format=kind.name)
        )


@contextmanager
def _unsubdivided(objects: list[bpy.types.Object], but_for_said: bool) -> Iterator[None]:
    """Shape keys move control vertices: subdivision is for the program that opens the file.

    but_for_said: leaves on what the exporter itself leaves out and has the file say instead.
    """
    hidden = []
    for obj in objects:
        shown = [modifier for modifier in obj.modifiers if modifier.show_viewport]
        if but_for_said and shown and _is_said(shown[-1]):
            shown.pop()
        hidden += [modifier for modifier in shown if modifier.type in ("SUBSURF", "MULTIRES")]
    for modifier in hidden:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in hidden:
            modifier.show_viewport = True


def _is_said(last: bpy.types.Modifier) -> bool:
    return last.type == "SUBSURF" and last.subdivision_type == "CATMULL_CLARK"


@contextmanager
def _whole_range(
    scene: bpy.types.Scene, objects: list[bpy.types.Object]
) -> Iterator[tuple[int, int]]:
    """The first and the last frame of the objects' curves, else of the scene's range; for the while
    that is these, from frame 0 on."""
    before = scene.frame_start, scene.frame_end, scene.frame_current_final
    holders = [compat.curves(block) for obj in objects for block in (obj, _keys(obj)) if block]
    ends = [
        end
        for holder in holders
        if holder is not None
        for curve in holder.fcurves
        for end in curve.range()
    ]
    first, last = before[:2]
    if ends:
        first, last = math.floor(min(ends)), math.ceil(max(ends))
        scene.frame_start, scene.frame_end = max(first, 0), max(last, 0)
    try:
        yield first, last
    finally:
        scene.frame_start, scene.frame_end, current = before
        scene.frame_set(math.floor(current), subframe=current % 1)


def _keys(obj: bpy.types.Object) -> bpy.types.Key | None:
    return getattr(obj.data, "shape_keys", None)
