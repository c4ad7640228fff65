# SPDX-License-Identifier: GPL-3.0-or-later
"""Head and neck of a rig that a live head turns."""

from __future__ import annotations

import bpy

from .. import compat, native
from . import head


class LiveHeadBones:
    """The bones of a target while a live session turns them, as a bake would."""

    def __init__(self, armature: bpy.types.Object, target: head.Target) -> None:
        self._carry = head.bone_carrier(bpy.context.scene, armature, target)
        self.names = [name for name in (target.bone, target.neck) if name]
        self.rest = None  # head pose from which the head turns

    def show(self, armature: bpy.types.Object, pose) -> None:
        """pose: 4 x 4, camera from head."""
        self.rest = pose if self.rest is None else self.rest
        for name, channels in self._channels(pose[None]).items():
            if (bone := armature.pose.bones.get(name)) is not None:
                setattr(bone, channels.rotation_path, channels.rotations[0])

    def record(self, armature: bpy.types.Object, performance, frames) -> int:
        """Keys the turns in the armature's own action; returns the number of curves."""
        self.rest = performance.head_pose[0] if self.rest is None else self.rest
        channels = self._channels(performance.head_pose)
        return head.key_bones(compat.curves(armature), frames, channels)

    def _channels(self, poses) -> dict:
        parts = native.puppet("driven_face")
        carried = self._carry(parts.head_motion(poses, self.rest))
        return {name: parts.after_rest(channels) for name, channels in carried.items()}
