# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import IntProperty
from bpy.types import Operator

from .. import jobs, outcome, playback, plural
from ..greyed import Greyed


class MIMETIC_OT_stop(Greyed, Operator):
    """Stop a job; a capture keeps what is done so far. Esc stops the one at work"""

    bl_idname = "mimetic.stop"
    bl_label = "Stop"
    bl_options = {"INTERNAL"}

    index: IntProperty(
        name="Job", min=0, options={"SKIP_SAVE"}, description="0: at work; from 1 on: waiting"
    )

    @classmethod
    def obstacle(cls, context):
        return "" if jobs.running else "No job is at work"

    def invoke(self, context, event):
        """By the button; or by Esc in a window that is not the job's own, which hears it itself."""
        if event.type != "ESC":
            return self.execute(context)
        if playback.was_on or context.window.screen.is_temporary:
            return {"PASS_THROUGH"}  # it means the playback, or nothing
        jobs.discard_running()
        return outcome.finished(self, context, "")

    def execute(self, context):
        if self.index == 0:
            jobs.running.stop.set()
        elif self.index <= len(jobs.waiting):
            jobs.waiting.pop(self.index - 1)
        else:
            return outcome.cancelled(
                self,
                context,
                plural.one_or_many(
                    len(jobs.waiting), rpt_("1 job waits"), rpt_("{count} jobs wait")
                ).format(count=len(jobs.waiting)),
            )
        return outcome.finished(self, context, "")
