# SPDX-License-Identifier: GPL-3.0-or-later
"""A body on a rig of Rigify's human, and an animation of it: what a face should leave alone."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager

BLEND = "Body"
SKULL = "DEF-spine.006"
# Of the bones' deform copies: metres, the radius of the limb round each
RADII = {
    **{r"spine(\.00[1-3])?$": 0.14, r"spine\.00[45]$": 0.055, "shoulder": 0.075},
    **{"upper_arm": 0.055, "forearm": 0.045, "hand": 0.04, r"(f_|thumb)": 0.018},
    **{"thigh": 0.085, "shin": 0.06, "foot": 0.05, "toe": 0.045, "pelvis": 0.11},
}
BALLS = 6  # along a bone
RESOLUTION = 0.018  # metres
# Bone, channel, axis: its values at the keyed frames
IDLE = {
    ("torso", "location", 0): (0.0, 0.03, -0.03, 0.0),
    ("hand_ik.L", "location", 2): (0.0, 0.35, 0.35, 0.0),
    ("hand_ik.L", "location", 1): (0.0, -0.2, -0.25, 0.0),
    ("hand_ik.R", "location", 1): (0.0, -0.05, -0.1, 0.0),
    ("chest", "rotation_quaternion", 2): (0.0, 0.05, -0.05, 0.0),
}


def add_body(rig):
    """A mesh about the deform bones below the head, deformed by automatic weights."""
    import bpy

    balls = bpy.data.metaballs.new(BLEND)
    balls.resolution, balls.threshold = RESOLUTION, 0.6
    for bone in rig.data.bones:
        radius = _radius(bone.name)
        for step in range(BALLS if radius else 0):
            ball = balls.elements.new()
            ball.co = bone.head_local.lerp(bone.tail_local, step / (BALLS - 1))
            ball.radius, ball.stiffness = 1.6 * radius, 2.0
    blob = bpy.data.objects.new(BLEND, balls)
    bpy.context.scene.collection.objects.link(blob)
    _select(blob)
    bpy.ops.object.convert(target="MESH")
    body = bpy.context.view_layer.objects.active
    body.name = body.data.name = BLEND
    bpy.ops.object.shade_smooth()
    _select(body, rig)
    with deformed_by(rig, lambda name: name == SKULL or _radius(name) > 0):
        bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    cloth = bpy.data.materials.new("Cloth")
    cloth.diffuse_color = (0.09, 0.13, 0.22, 1.0)
    body.data.materials.append(cloth)
    return body


@contextmanager
def deformed_by(rig, is_near: Callable[[str], bool]) -> Iterator[None]:
    """While it lasts bones that are not near a mesh deform none: each one's automatic weights
    take long, even if they are none."""
    far = [bone for bone in rig.data.bones if bone.use_deform and not is_near(bone.name)]
    for bone in far:
        bone.use_deform = False
    try:
        yield
    finally:
        for bone in far:
            bone.use_deform = True


def is_limb(name: str) -> bool:
    """Whether a bone is of the body, below the spine's upper end."""
    return _radius(name) > 0 and not name.startswith("DEF-spine")


def animate(rig, first: int, last: int) -> None:
    """Keys an idle of torso and hands, in the action `Idle`."""
    import bpy

    action = bpy.data.actions.new("Idle")
    rig.animation_data_create().action = action
    for (name, channel, axis), values in IDLE.items():
        bone = rig.pose.bones[name]
        for number, value in enumerate(values):
            frame = first + (last - first) * number / (len(values) - 1)
            getattr(bone, channel)[axis] = value
            bone.keyframe_insert(channel, index=axis, frame=frame, group=name)


def _radius(name: str) -> float:
    if not name.startswith("DEF-"):
        return 0.0
    found = (radius for part, radius in RADII.items() if re.match(part, name[4:]))
    return next(found, 0.0)


def _select(*objects) -> None:
    """Selects these alone; the last is active."""
    import bpy

    for obj in bpy.context.selected_objects:
        obj.select_set(False)
    for obj in objects:
        obj.select_set(True)
    bpy.context.view_layer.objects.active = objects[-1]
