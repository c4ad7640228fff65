# SPDX-License-Identifier: GPL-3.0-or-later
"""Captured takes of the clip: which is used, and which are listed."""

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy.types import Operator

from .. import captured_takes, editors, native, outcome, scene_in
from ..greyed import Greyed


def _names(self, context, text) -> list[str]:
    return [row.name for row in captured_takes.of_clip(scene_in.clip_of(context))]


class OnCapturedTake(Greyed):
    """Mixin. Subclasses give `use(context, clip, row)`: the line for the user, and facts."""

    bl_options = {"UNDO"}

    take: StringProperty(
        name="Captured Take",
        search=_names,
        options={"SKIP_SAVE"},
        description="By its name in the list; empty: the row that is shown",
    )

    @classmethod
    def obstacle(cls, context):
        if reason := scene_in.no_clip(context):
            return reason
        if not len(captured_takes.of_clip(scene_in.clip_of(context))):
            return "No take was captured of the clip: press Capture, or Load Performance, first"
        return ""

    def execute(self, context):
        clip = scene_in.clip_of(context)
        try:
            row = captured_takes.find(clip, self.take)
            facts = {"clip": clip.name, "take": row.name}
            message, more = self.use(context, clip, row)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        editors.redraw()
        return outcome.finished(self, context, message, **facts, **more)


class MIMETIC_OT_use_captured_take(OnCapturedTake, Operator):
    """Have overlays, corrections and Bake use this captured take; what was baked stays"""

    bl_idname = "mimetic.use_captured_take"
    bl_label = "Use Captured Take"

    def use(self, context, clip, row):
        name = row.name
        path, facts = captured_takes.use(context.scene, clip, row)
        frames = [facts.first, facts.last]
        message = rpt_("{take} is used: frames {first} to {last}").format(
            take=name, first=facts.first, last=facts.last
        )
        return message, {"performance": path, "footage_frames": frames}


class MIMETIC_OT_remove_captured_take(OnCapturedTake, Operator):
    """Take a captured take off the list; its file stays, and Load Performance lists it again"""

    bl_idname = "mimetic.remove_captured_take"
    bl_label = "Remove Captured Take"

    def use(self, context, clip, row):
        message = rpt_("{take} is off the list; its file stays").format(take=row.name)
        captured_takes.remove(clip, row)
        return message, {}


CLASSES = (MIMETIC_OT_use_captured_take, MIMETIC_OT_remove_captured_take)
