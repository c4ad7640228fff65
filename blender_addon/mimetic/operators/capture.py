# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.types import Operator

from .. import corrections, frame_at_hand, jobs, native, scene_in
from .following import Following


class MIMETIC_OT_capture(Following, Operator):
    """Follow the head and solve the muscles through the clip; stopping keeps what is done"""

    bl_idname = "mimetic.capture"
    bl_label = "Capture"
    message = "Captured frames {first} to {last}"

    def option(self, context):
        clip_capture = native.clip_capture()
        self.so_far = clip_capture.FramesSoFar()
        self._playhead = frame_at_hand.Playhead(context.scene)
        entries = corrections.of_clip(scene_in.clip_of(context))
        return entries, self.so_far, clip_capture.CaptureSummary()

    @staticmethod
    def learned(option):
        _, _, summary = option
        return summary.fit

    def accompany(self, context):
        newest = self.so_far.newest
        return newest is not None and self._playhead.accompany(
            context, jobs.running.subject, newest
        )

    @staticmethod
    def follow(option, footage_path, progress, frames, **person):
        entries, so_far, summary = option
        first, last = frames or (None, None)
        within = tuple(c for c in entries if (first or 1) <= c.frame <= (last or c.frame))
        return native.clip_capture().capture(
            footage_path,
            frames=frames,
            progress=progress,
            summary=summary,
            corrections=within,
            so_far=so_far,
            **person,
        )
