# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance into a scene. `bake` is what the operator and the command line both call."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from mathutils import Matrix

from .. import clip_lens, native, scene_in, targets, writable
from . import (
    actions,
    arkit,
    bound,
    bound_controls,
    camera,
    canonical,
    clip,
    control_object,
    control_removal,
    control_take,
    cover,
    curve_edits,
    exports,
    expression_strips,
    expressions,
    face,
    face_bones,
    face_curves,
    face_fit,
    few_keys,
    foreign,
    gltf,
    head,
    landmarks,
    live,
    live_controls,
    lost_markers,
    materials,
    movers,
    over_footage,
    own_keys,
    part_keys,
    rigs,
    sliders,
    stabilised,
    take_comparison,
    take_list,
)

__all__ = [
    "BakeSummary",
    "arkit",
    "bake",
    "bound",
    "bound_controls",
    "camera",
    "canonical",
    "clip",
    "control_object",
    "control_removal",
    "cover",
    "curve_edits",
    "exports",
    "expression_strips",
    "expressions",
    "face",
    "face_bones",
    "face_curves",
    "face_fit",
    "few_keys",
    "foreign",
    "gltf",
    "head",
    "landmarks",
    "live",
    "live_controls",
    "lost_markers",
    "over_footage",
    "part_keys",
    "rigs",
    "sliders",
    "stabilised",
    "take_comparison",
    "take_list",
]


@dataclass(frozen=True)
class BakeSummary:
    first: float  # scene frames of the first and the last key
    last: float
    num_curves: int
    kept: str = ""  # what was changed by hand and stays, a line for the user
    # That the face is a second one, what drivers set, why it does not stay before its footage
    remark: str = ""


def bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    appearance=None,
    footage: bpy.types.MovieClip | None = None,
    subdivision: int = 1,
    with_groups: bool = True,
    contact_shapes: list | None = None,
    is_reset: bool = False,
    tolerance: float = 0.0,
    with_units: bool = False,
    by_phases: bool = False,
    use_controls: bool = False,
    as_arkit: bool = False,
) -> BakeSummary:
    """Puts the face, its curves, its camera and the footage behind it into the scene.

    performance: mimetic.performance.Performance; take: names the new actions; appearance: of
    mimetic.appearance, colours of the face, or None to leave materials alone; footage: what it was
    captured from; with_groups: whether the face gets sliders of its groups of muscles too;
    contact_shapes: of mimetic.contact_shapes; given, even if empty, lips and lids are kept apart
    when sliders are moved afterwards too, and no longer if not given;
    is_reset: what was changed by hand on a face that was there is undone instead of kept;
    tolerance, by_phases: of few keys, as `actions.key_shapes` has them; with_units: sliders of
    FACS's action units, and an action asset each, beside the muscles; use_controls: curves lie on a
    control object that drives the shape keys; as_arkit: the face has ARKit's 52 shapes instead of
    muscles, whose groups it cannot have.
    The scene's rate, frame range and resolution stay as they are. Raises InvalidInput, and changes
    nothing then, where face or camera are linked from another file or what moves the face is flat.
    """
    writable.check(targets.no_update(scene))
    known_face, other = face.find(scene, performance), face.passed_over(scene, performance)
    writable.check(control_object.no_bake(known_face, use_controls))
    if tolerance > 0:
        native.sparse_curves().check_tolerance(tolerance)
    # First: to know where camera and parent stand evaluates curves of before
    world_from_camera = _world_from_camera(scene)
    motion = _motion(performance, known_face, world_from_camera)
    timing = scene_in.timing(scene, footage)
    frames = scene_in.scene_frames(performance, timing)
    shapes = _shapes(performance, with_units, as_arkit) + (contact_shapes or [])
    groups = native.shapes().groups_of(performance) if with_groups else []
    obj, hand_changes = face.ensure(scene, performance, shapes, groups, subdivision, is_reset)
    obj.mimetic.use_contact = contact_shapes is not None
    if appearance is not None:
        has_paint = materials.dress(obj, appearance, is_reset)
        text = iface_("the picture of {name}")
        hand_changes.things += [text.format(name=name) for name in has_paint]
    if with_units:
        expressions.ensure_units(timing.scene_rate)
    if use_controls and control_take.prepare(scene, obj, performance):
        motion = _motion(performance, obj, world_from_camera)
    key_face = control_take.key_face if use_controls else _key_face
    num_curves = key_face(obj, performance, take, frames, motion, shapes, tolerance, by_phases)
    _show_camera(scene, performance, world_from_camera, footage, timing, take)
    first, last = float(frames[0]), float(frames[-1])
    remark = _remark(scene, obj, [] if use_controls else shapes)
    remark = "; ".join(filter(None, (face.second_remark(scene, obj, other), remark)))
    return BakeSummary(first, last, num_curves, hand_changes.text(), remark)


def _world_from_camera(scene: bpy.types.Scene):
    found = scene_in.camera_matrix(scene)
    return native.placement().WORLD_FROM_SCENE_CAMERA if found is None else found


def _motion(performance, obj: bpy.types.Object | None, world_from_camera):
    """`mimetic.rig_motion.Channels` of a face that is there, or of one that will be made."""
    space = Matrix() if obj is None else control_object.head_space(obj)
    return head.placed(performance, space, world_from_camera)


def _remark(scene: bpy.types.Scene, obj: bpy.types.Object, shapes) -> str:
    remarks = own_keys.driven_remark(obj, _driven_keys(obj, shapes)), _mover_remark(scene, obj)
    return "; ".join(filter(None, remarks))


def _mover_remark(scene: bpy.types.Scene, obj: bpy.types.Object) -> str:
    mover = control_object.head_mover(obj)
    if not mover or movers.animated_mover(scene.mimetic.camera) == mover:  # they go together
        return ""
    return rpt_(
        "{mover} is animated and moves {face}, which is before its footage in frame {frame:.6g} "
        "alone"
    ).format(mover=mover, face=obj.name, frame=scene.frame_current_final)


def _shapes(performance, with_units: bool, as_arkit: bool) -> list:
    if as_arkit:
        return native.unit_fit().unit_shapes(performance)
    parts = native.shapes()
    units = parts.shapes_of_units(performance.neutral_vertices) if with_units else []
    return [*parts.shapes_of(performance), *units]


def _key_face(
    obj: bpy.types.Object, performance, take: str, frames, motion, shapes, *keys_like
) -> int:
    names, driven = face.key_names(obj), _driven_keys(obj, shapes)
    played = [shape for shape in shapes if names[shape.name] not in driven]
    num_curves = actions.key_shapes(obj, take, frames, played, names, *keys_like)
    return num_curves + actions.key_motion(obj, take, frames, motion)


def _driven_keys(obj: bpy.types.Object, shapes) -> list[str]:
    """The shapes' keys that drivers set: a curve on them would do nothing."""
    names, driven = face.key_names(obj), own_keys.driven_keys(obj.data.shape_keys)
    moving = (names[shape.name] for shape in shapes if len(shape.values))
    return [name for name in moving if name in driven]


def _show_camera(scene, performance, world_from_camera, footage, timing, take: str) -> None:
    """The footage's camera where the performance has it, and the footage behind the face."""
    lens = native.placement().lens(
        performance.intrinsics,
        performance.image_size,
        scene_in.picture_size(scene),
        scene_in.pixel_aspect(scene),
        clip_lens.sensor_of(footage, performance),
    )
    seen_through = camera.ensure(scene, lens, world_from_camera)
    if footage is not None:
        camera.show_footage(seen_through, footage, timing, performance, take)
