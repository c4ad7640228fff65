# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance into a scene. `bake` is what the operator and the command line both call."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_iface as iface_

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
    over_footage,
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
    mimetic.appearance, colours of the face, or None to leave materials alone;
    footage: what the performance was captured from; with_groups: whether the face gets sliders of
    its groups of muscles too; contact_shapes: of mimetic.contact_shapes; given, even if empty, lips
    and lids are kept apart when sliders are moved afterwards too, and no longer if not given;
    is_reset: what was changed by hand on a face that was there is undone instead of kept;
    tolerance, by_phases: of few keys, as `actions.key_shapes` has them;
    with_units: sliders of FACS's action units, and an action asset each, beside the muscles;
    use_controls: curves lie on a control object that drives the shape keys, not on these;
    as_arkit: the face has ARKit's 52 shapes instead of muscles, whose groups it cannot have.
    The scene's rate, frame range and resolution stay as they are. Raises InvalidInput, and changes
    nothing then, where face or camera are linked from another file.
    """
    writable.check(targets.no_update(scene))
    writable.check(control_object.no_bake(face.find(scene, performance), use_controls))
    placement = native.placement()
    if tolerance > 0:
        native.sparse_curves().check_tolerance(tolerance)
    # First: to know where the camera stands evaluates curves of before
    world_from_camera = scene_in.camera_matrix(scene)
    if world_from_camera is None:
        world_from_camera = placement.WORLD_FROM_SCENE_CAMERA
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
    motion = placement.head_motion(performance, world_from_camera)
    like = take, frames, motion, shapes, tolerance, by_phases
    if use_controls:
        num_curves = control_take.key_face(scene, obj, performance, *like)
    else:
        num_curves = _key_face(obj, *like)
    _show_camera(scene, performance, world_from_camera, footage, timing, take)
    return BakeSummary(float(frames[0]), float(frames[-1]), num_curves, hand_changes.text())


def _shapes(performance, with_units: bool, as_arkit: bool) -> list:
    if as_arkit:
        return native.unit_fit().unit_shapes(performance)
    parts = native.shapes()
    units = parts.shapes_of_units(performance.neutral_vertices) if with_units else []
    return [*parts.shapes_of(performance), *units]


def _key_face(obj: bpy.types.Object, take: str, frames, motion, shapes, *keys_like) -> int:
    names = face.key_names(obj)
    num_curves = actions.key_shapes(obj, take, frames, shapes, names, *keys_like)
    return num_curves + actions.key_motion(obj, take, frames, motion)


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
