# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character in a copy of a .blend: what `mimetic bake --target` calls."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import bpy

from .. import native, scene_in, takes, writable
from . import (
    arkit_target,
    blend_file,
    bound,
    bound_controls,
    bound_eyes,
    camera,
    clip,
    contact_curves,
    control_object,
    control_removal,
    control_values_file,
    exports,
    face_bones,
    head,
    own_controls,
    own_keys,
    rigs,
    take_list,
)
from .motion_keys import MotionKeys


def write(
    performance_path: str,
    out: str,
    rig_path: str,
    name: str,
    settings: dict,
    footage_path: str | None = None,
    curves: dict | None = None,
) -> str:
    """Opens `rig_path`, keys the performance on its object `name`, and writes `out` whole.

    A head that has the muscles' sliders plays them; one whose own shape keys have known names, or
    are asked for, plays those; an armature plays the face on its bones if asked for; any other
    object, or an armature's head and neck, gets the head's motion. settings: controls, "own",
    "muscles", or "auto" for what there is, muscles first; bone and neck, found by name where None;
    neck_share; smoothing, of the head's motion alone; tolerance and by_phases, of few keys, as
    `actions.key_shapes` has them, and `MotionKeys` of bones and objects; as_arkit, ARKit's 52
    shapes for the file, and with_eye_nodes, eyeballs as objects that turn, both for other programs.
    curves: `takes.load_edited`'s. The file keeps its own rate, range and everything else; its
    scripts do not run; `_show_footage` puts the footage behind. Other files than .blend have the
    object, its rig and what hangs on them, a control object's sliders by themselves; an .npz has
    the values of its controls alone (`control_values_file`).
    Returns what was written.
    """
    performance = takes.load_edited(performance_path, curves)
    where = f"--target {Path(rig_path).name}"
    scene = open_file(rig_path, where)
    obj = _object(scene, where, name, settings)
    if Path(out).suffix == ".npz":
        is_own = obj.type == "MESH" and _plays_own(obj, where, settings.get("controls", "auto"))
        return control_values_file.write(scene, performance, obj, settings, is_own, out)
    footage = clip.load(scene, footage_path) if footage_path else None
    take = takes.take_name(footage_path or performance_path)
    is_exported = Path(out).suffix != ".blend"
    if is_exported and control_object.of(obj) is not None:  # which no other format has
        control_removal.remove(scene, obj, use_curves=False)
    before = take_list.now(obj)
    few_keys = settings.get("tolerance", 0.0), settings.get("by_phases", False)
    eyes = None
    if settings.get("with_eye_nodes"):
        if reason := bound_eyes.no_eyes(performance, obj):
            raise native.invalid_input(f"{where}: {reason}")
        eyes = bound_eyes.BoundEyes(scene, obj)
    text = _bake(scene, performance, take, obj, where, settings, footage, few_keys)
    timing = scene_in.timing(scene, footage)
    frames = scene_in.scene_frames(performance, timing)
    how = _settings_text(*few_keys)
    take_list.note(obj, performance, take, performance_path, frames, how, before)
    if not is_exported:
        text += _show_footage(scene, footage, timing, performance, take)
        blend_file.save_copy(Path(out).absolute(), with_paths_anew=True)
        return text
    with ExitStack() as stack:
        if eyes is not None:
            # Of the whole mesh: contact knows its vertices by their numbers
            stack.enter_context(contact_curves.with_keys(scene, obj))
            names = eyes.split(scene, performance, footage, take)
            text += f"; {', '.join(names)} turn"
        loses = exports.write(scene, out, obj)
    return "; ".join(filter(None, (text, loses)))


def _bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    obj: bpy.types.Object,
    where: str,
    settings: dict,
    footage,
    few_keys: tuple[float, bool],
) -> str:
    """The performance on what of the object plays it; returns what was keyed."""
    choice, keys = settings.get("controls", "auto"), MotionKeys(*few_keys)
    if settings.get("as_arkit"):
        summary = arkit_target.bake(scene, performance, take, obj, footage, *few_keys)
        return f"{summary.num_curves} curves on {obj.name}, {_frames(summary)}; {summary.text}"
    if obj.type == "ARMATURE" and choice == "own":
        target = _target(obj, where, settings)
        return _play_bones(scene, performance, take, target, settings, footage, keys)
    if _plays_own(obj, where, choice):
        played = own_controls.play(performance, obj, settings.get("preset"))
        summary = own_controls.bake(scene, performance, take, obj, played, footage, True, *few_keys)
        return f"{summary.num_curves} curves on {obj.name}, {_frames(summary)}; {summary.text}"
    own_controls.check_no_preset(obj, settings.get("preset"))
    if scene_in.is_face(obj):
        return _play(scene, performance, take, obj, footage, settings, few_keys)
    target = _target(obj, where, settings)
    summary = _turn(scene, performance, take, target, settings, footage, keys)
    text = f"{summary.num_curves} curves on {summary.where}, {_frames(summary)}"
    return "; ".join(filter(None, (text, keys.text())))


def _show_footage(scene: bpy.types.Scene, footage, timing, performance, take: str) -> str:
    """The footage behind what the file's own camera sees, which looks as before else.

    Returns what to say of it, if there is any.
    """
    if footage is None:
        return ""
    seen_through = scene.camera
    if seen_through is None or seen_through.type != "CAMERA":
        reason = "the scene has no camera"
    elif not (reason := writable.no_lens(seen_through)):
        animation = seen_through.data.animation_data
        if seen_through.data.background_images or (animation and animation.action):
            reason = f"{seen_through.name} has images or curves of its own"
    if reason:
        return f"; {footage.name} is loaded and behind no camera: {reason}"
    camera.show_footage(seen_through, footage, timing, performance, take)
    return f"; {footage.name} behind what {seen_through.name} sees"


def _settings_text(tolerance: float, by_phases: bool) -> str:
    """What the list of takes says of one that was baked here."""
    text = "by mimetic bake"
    if tolerance:
        text += f", few keys within {tolerance:.3g}" + (", at phases" if by_phases else "")
    return text


def open_file(path: str, where: str) -> bpy.types.Scene:
    """Opens a user's file without running its scripts; returns its scene. where: names it."""
    try:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise native.invalid_input(f"{where}: {error}") from None
    return bpy.context.scene


def find_object(scene: bpy.types.Scene, where: str, name: str) -> bpy.types.Object:
    """Raises what bad input raises if the scene does not have it."""
    if name not in scene.objects:
        names = ", ".join(sorted(other.name for other in scene.objects)[:12])
        raise native.invalid_input(f"{where} has no object {name}; it has {names or 'none'}")
    return scene.objects[name]


def _turn(
    scene, performance, take: str, target: head.Target, settings: dict, footage, keys: MotionKeys
):
    """The head's motion, smoothed, on an object or an armature's bones."""
    smooth = native.head_smoothing().smoothed(performance, settings["smoothing"])
    return head.bake(scene, smooth, take, target, footage, keys)


def _play_bones(
    scene, performance, take: str, target: head.Target, settings: dict, footage, keys: MotionKeys
) -> str:
    """The face on a rig's bones, and the head's motion in the same action."""
    rig = scene.objects[target.name]
    played = face_bones.play(scene, performance, rig, settings.get("preset"))
    summary = _turn(scene, performance, take, target, settings, footage, keys)
    num_curves = face_bones.key(scene, performance, rig, played, footage, keys) + summary.num_curves
    texts = (f"{num_curves} curves on {rig.name}, {_frames(summary)}", keys.text())
    return "; ".join(filter(None, (*texts, played.summary())))


def _plays_own(obj: bpy.types.Object, where: str, choice: str) -> bool:
    """Whether the face goes on the object's own shape keys."""
    if choice == "muscles" and not scene_in.is_face(obj):
        raise native.invalid_input(
            f"{where}:{obj.name} has no muscles; attach them first, or leave --controls out"
        )
    if choice == "own" and (reason := own_keys.no_own_keys(obj)):
        raise native.invalid_input(f"{where}: {reason}")
    if choice != "auto" or scene_in.is_face(obj) or own_keys.no_own_keys(obj):
        return choice == "own"
    return bool(native.control_names().known_names(key.name for key in own_keys.own_keys(obj)))


def _frames(summary) -> str:
    return f"frames {summary.first:.6g} to {summary.last:.6g}"


def _play(
    scene: bpy.types.Scene,
    performance,
    take: str,
    face,
    footage,
    settings: dict,
    few_keys: tuple[float, bool],
) -> str:
    """The performance on a head's own sliders or control object, as the button Bake puts it."""
    control_object.forget_lost(face)
    on_bones = settings.get("control_object") or control_object.of(face)
    bake = bound_controls.bake if on_bones else bound.bake
    summary = bake(scene, performance, take, face, footage, True, *few_keys)
    remarks = "".join(f"; {remark}" for remark in summary.left_out)
    return f"{summary.num_curves} curves on {face.name}, {_frames(summary)}{remarks}"


def _object(scene: bpy.types.Scene, where: str, name: str, settings: dict) -> bpy.types.Object:
    obj = find_object(scene, where, name)
    if settings.get("control_object") and not scene_in.is_face(obj):
        raise native.invalid_input(
            f"{where}:{name} has no muscles for --control-object; attach them, or leave it out"
        )
    if obj.type != "ARMATURE":
        if settings["bone"] or settings["neck"]:
            raise native.invalid_input(
                f"{where}:{name} is no armature; leave --bone and --neck out"
            )
    elif obj.mode == "EDIT":
        raise native.invalid_input(
            f"{where}:{name} was saved in edit mode; leave it and save again"
        )
    return obj


def _target(obj: bpy.types.Object, where: str, settings: dict) -> head.Target:
    name = obj.name
    if obj.type != "ARMATURE":
        return head.Target(name)
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
