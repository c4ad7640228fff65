# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame that a job is at, on show while it works."""

from __future__ import annotations

import bpy

from . import editors, playback, scene_in


class Playhead:
    """Goes along with a job while it stands where it was put: whoever scrubs or plays takes it,
    and gives it back by going to the frame where it was left."""

    def __init__(self, scene: bpy.types.Scene) -> None:
        self._scene = scene.session_uid
        self._left_at = scene.frame_current

    def accompany(self, context, clip_name: str, frame: int) -> bool:
        """Says whether it moved."""
        clip, scene = bpy.data.movieclips.get(clip_name), context.scene
        if clip is None or scene.session_uid != self._scene or not _is_on_show(scene, clip):
            return False
        if scene.frame_current != self._left_at or playback.has_the_playhead():
            return False
        self._left_at = scene_in.scene_frame(clip, frame)
        if scene.frame_current == self._left_at:
            return False
        scene.frame_current = self._left_at
        return True


def _is_on_show(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> bool:
    """Whether an editor draws the captured face over this footage."""
    shown = (area.spaces.active.clip for area in editors.open_editors("CLIP_EDITOR"))
    return scene.mimetic.show_capture and clip in shown
