# SPDX-License-Identifier: GPL-3.0-or-later
"""The face as a binary glTF file: morph targets, their weights' animation, the head's motion."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import bpy

from .. import compat, native, scene_in
from . import (
    contact_curves,
    control_object,
    exporter_reports,
    part_curves,
    selection,
    strip_curves,
)


def export(
    scene: bpy.types.Scene,
    path: str | os.PathLike[str],
    face: bpy.types.Object | None = None,
    is_animated: bool = True,
) -> str:
    """Writes a face, the scene's baked one if None, with its rig and what depends on that; whole,
    or raises OSError, or InvalidInput where it is hidden or a control object moves its shapes, and
    writes nothing.

    is_animated: with its curves; without, the mesh and its morph targets alone.
    Returns what is hidden, which the file does not have, or nothing.
    """
    path = Path(path)
    face = face or scene.mimetic.face
    with selection.scene_at_hand(scene), native.whole_file().file_beside(path, ".glb") as aside:
        _export(scene, path, aside, face, is_animated)
        return selection.left_out(scene, face)


def _export(
    scene: bpy.types.Scene, path: Path, aside: Path, face: bpy.types.Object, is_animated: bool
) -> None:
    """Writes `aside`, which is to be `path`."""
    objects = selection.character_objects(scene, face)
    shaped = selection.with_shape_keys(objects)
    for obj in shaped:
        if reason := control_object.no_values(obj):
            raise native.invalid_input(reason)
    current = scene.frame_current_final
    with ExitStack() as stack:
        stack.callback(scene.frame_set, math.floor(current), subframe=current % 1)
        stack.enter_context(selection.selected_alone(objects, face))
        stack.enter_context(strip_curves.with_curves(scene, objects))
        for obj in selection.one_a_mesh(shaped):
            # Contact's keys come behind the groups', whose number must not change then
            if not stack.enter_context(contact_curves.with_keys(scene, obj)):
                stack.enter_context(_without_idle_groups(obj))
        stack.enter_context(part_curves.with_curves(shaped))
        stack.enter_context(_whole_ranges(objects))
        try:
            _write(aside, is_animated)
        except RuntimeError as error:  # what the exporter reported
            raise exporter_reports.reported(error, path) from None
    # Blender's exporter multiplies by the rate's base where it should divide: at 23.976 frames
    # a second a minute would come out 120 ms short
    if is_animated:
        rate = scene_in.timing(scene, None).scene_rate
        files = native.gltf()
        aside.write_bytes(files.split_negative(files.retime(aside.read_bytes(), rate)))


def _write(aside: Path, is_animated: bool) -> None:
    """What is selected in the context's scene, by Blender's exporter."""
    bpy.ops.export_scene.gltf(
        filepath=str(aside),
        export_format="GLB",
        use_selection=True,
        use_active_scene=True,
        export_yup=True,
        export_apply=False,
        export_def_bones=True,
        export_image_format="JPEG",
        export_image_quality=90,
        export_morph=True,
        export_morph_normal=True,
        export_morph_animation=True,
        export_animations=is_animated,
        export_animation_mode="ACTIVE_ACTIONS",
        export_nla_strips_merged_animation_name="Performance",
        export_force_sampling=True,
        export_frame_range=False,
        export_anim_slide_to_zero=True,
        export_optimize_animation_size=False,
    )


@contextmanager
def _whole_ranges(objects: Iterable[bpy.types.Object]) -> Iterator[None]:
    """While it lasts, the objects' actions end at whole frames: the exporter writes the whole
    frames of an action's range, so that what comes after the last of them would be lost."""
    blocks = (block for obj in objects for block in (obj, getattr(obj.data, "shape_keys", None)))
    animated = [block.animation_data for block in blocks if block and block.animation_data]
    before = []
    try:
        for action in {animation.action: None for animation in animated if animation.action}:
            first, last = action.frame_range
            before.append((action, action.use_frame_range, action.frame_start, action.frame_end))
            action.use_frame_range = True
            action.frame_start, action.frame_end = math.floor(first), math.ceil(last)
        yield
    finally:
        for action, is_used, first, last in before:
            action.use_frame_range, action.frame_start, action.frame_end = is_used, first, last


@contextmanager
def _without_idle_groups(face: bpy.types.Object):
    """Leaves out sliders of groups that do nothing: half as many morph targets again.

    The exporter leaves muted keys out. They come last, so that no other key's number changes.
    """
    keys = face.data.shape_keys
    moving_paths = {curve.data_path for curve in getattr(compat.curves(keys), "fcurves", ())}
    animation = keys.animation_data
    is_free = animation is None or not (animation.drivers or animation.nla_tracks)
    idle = [
        key
        for key in (keys.key_blocks.get(entry.name) for entry in face.mimetic.groups)
        if key
        and is_free
        and key.value == 0
        and not key.mute
        and key.path_from_id("value") not in moving_paths
    ]
    for key in idle:
        key.mute = True
    try:
        yield
    finally:
        for key in idle:
            key.mute = False
