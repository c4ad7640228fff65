# SPDX-License-Identifier: GPL-3.0-or-later
"""What operators that change corrections have in common."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, FloatProperty, IntProperty

from .. import corrections, editors, native, outcome, scene_in
from ..greyed import Greyed

REACH = FloatProperty(
    name="Reach",
    default=8.0,
    min=1.0,
    soft_max=60.0,
    max=1000.0,
    description="Frames before and after from which on nothing of the correction counts",
)
FRAME = IntProperty(
    name="Frame", min=0, options={"SKIP_SAVE"}, description="Of the footage; 0: the one on show"
)


class Correcting(Greyed):
    """Mixin of operators that change corrections.

    `change(context, earlier, frame)` gives the new ones.
    """

    bl_options = {"REGISTER", "UNDO"}
    obstacle = staticmethod(corrections.no_corrections)

    frame: FRAME
    is_of_shown: BoolProperty(
        name="Frame on Show",
        options={"HIDDEN", "SKIP_SAVE"},
        description="The playhead goes to it again: the redo panel's undo takes it elsewhere",
    )

    def execute(self, context):
        clip = scene_in.clip_of(context)
        self.is_of_shown = self.is_of_shown or not self.frame
        frame = self.frame = self.frame or scene_in.shown_frame(context)
        try:
            now = self.change(context, corrections.of_clip(clip), frame)
            corrections.keep(clip, now)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        if self.is_of_shown:
            context.scene.frame_current = scene_in.scene_frame(clip, frame)
        editors.redraw(*editors.OF_TAKES)
        frames = [entry.frame for entry in now]
        message = rpt_("{operator}: frame {frame}; Refine solves the frames around it").format(
            operator=iface_(self.bl_label, "Operator"), frame=frame
        )
        return outcome.finished(self, context, message, clip=clip.name, frames=frames)
