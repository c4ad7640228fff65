# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on the control object of a character whose head has the muscles' sliders."""

from __future__ import annotations

import bpy

from .. import native, scene_in, writable
from . import bound, control_drivers, control_object, control_take, head, own_keys


def bake(
    scene: bpy.types.Scene,
    performance,
    take: str,
    head_object: bpy.types.Object,
    footage: bpy.types.MovieClip | None = None,
    use_head_motion: bool = True,
    tolerance: float = 0.0,
    by_phases: bool = False,
) -> bound.BakeSummary:
    """As `bound.bake`, with the curves on a control object, which is made if there is none."""
    frames = scene_in.scene_frames(performance, scene_in.timing(scene, footage))
    shapes = bound.shapes_for(performance, head_object)
    sliders = bound.sliders_of(head_object, shapes)
    writable.check(control_object.no_controls(head_object))
    keys = head_object.data.shape_keys
    driven_keys = own_keys.driven_keys(keys) - control_drivers.keys_driven(head_object)
    remarks = bound.no_play(head_object, shapes, sliders, driven_keys)
    if not sliders:
        raise native.invalid_input("; ".join(remarks))
    carries = control_object.carries(head_object)
    if use_head_motion and not carries and (remark := bound.no_motion(head_object)):
        use_head_motion = False
        remarks.append(remark)
    is_object_moved = use_head_motion and not carries
    channels = bound.motion(scene, performance, head_object) if is_object_moved else None
    control_take.put_keys_away(head_object, performance)
    control = control_object.ensure(scene, head_object)
    num_curves = control_take.key(head_object, performance, take, frames, tolerance, by_phases)
    if channels is not None:
        num_curves += head.key_object(head_object, take, frames, channels)
        control_take.join(control, head_object)
    elif use_head_motion:
        units = bound.units_of(scene, head_object)
        num_curves += control_take.key_head_bone(scene, performance, take, control, footage, units)
    return bound.BakeSummary(
        float(frames[0]),
        float(frames[-1]),
        num_curves,
        use_head_motion,
        tuple(remarks),
        tuple(bound.untouched_by(head_object, {shape.name for shape in shapes})),
    )
