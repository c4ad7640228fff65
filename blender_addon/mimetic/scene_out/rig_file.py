# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance's head motion in a copy of someone's .blend: what `mimetic bake --target` calls."""

from __future__ import annotations

import os
from pathlib import Path

import bpy

from .. import native
from . import actions, clip, head, rigs


def write(
    performance_path: str,
    out: str,
    rig_path: str,
    name: str,
    settings: dict,
    footage_path: str | None = None,
) -> str:
    """Opens `rig_path`, keys the head's motion on its object `name`, and writes `out` whole.

    settings: bone and neck, found by name where None; neck_share; smoothing. The file keeps its own
    rate, range and everything else; its scripts do not run. Returns what was written.
    """
    performance = native.performances().Performance.load(performance_path)
    performance = native.head_smoothing().smoothed(performance, settings["smoothing"])
    try:
        bpy.ops.wm.open_mainfile(filepath=rig_path, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise native.invalid_input(f"--target {rig_path}: {error}") from None
    scene = bpy.context.scene
    target = _target(scene, rig_path, name, settings)
    footage = clip.load(scene, footage_path) if footage_path else None
    take = actions.take_name(footage_path or performance_path)
    summary = head.bake(scene, performance, take, target, footage)
    path = Path(out).absolute()
    # Beside `out`, so that relative paths hold once it has its name
    aside = path.with_name(f".{path.stem}.{os.getpid()}.blend")
    try:
        bpy.ops.wm.save_as_mainfile(
            filepath=str(aside), check_existing=False, relative_remap=True, copy=True
        )
        os.replace(aside, path)
    finally:
        aside.unlink(missing_ok=True)
    frames = f"{summary.first:.6g} to {summary.last:.6g}"
    return f"{summary.num_curves} curves on {summary.where}, frames {frames}"


def _target(scene: bpy.types.Scene, rig_path: str, name: str, settings: dict) -> head.Target:
    where = f"--target {Path(rig_path).name}"
    if name not in scene.objects:
        names = ", ".join(sorted(other.name for other in scene.objects)[:12])
        raise native.invalid_input(f"{where} has no object {name}; it has {names or 'none'}")
    obj = scene.objects[name]
    if obj.type != "ARMATURE":
        if settings["bone"] or settings["neck"]:
            raise native.invalid_input(
                f"{where}:{name} is no armature; leave --bone and --neck out"
            )
        return head.Target(name)
    if obj.mode == "EDIT":
        raise native.invalid_input(
            f"{where}:{name} was saved in edit mode; leave it and save again"
        )
    by_name = rigs.head_bones(obj)
    bone = settings["bone"] or by_name.head
    neck = by_name.neck if settings["neck"] is None else settings["neck"]
    if not bone:
        raise native.invalid_input(f"{where}: {by_name.remark} by --bone")
    for bone_name in filter(None, (bone, neck)):
        if bone_name not in obj.pose.bones:
            raise native.invalid_input(f"{where}:{name} has no bone {bone_name}")
    if bone == neck:
        raise native.invalid_input(f"--neck {neck} is the head's own bone; choose another")
    return head.Target(name, bone, neck, settings["neck_share"], translation_scale=0.0)
