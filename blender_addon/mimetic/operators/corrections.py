# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections of single frames: pins on the captured skin, what is deleted, and refining."""

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, StringProperty
from bpy.types import Operator

from .. import (
    captured_takes,
    clips,
    corrections,
    editors,
    native,
    outcome,
    plural,
    scene_in,
    takes,
)
from ..greyed import Greyed
from ..jobs import Job
from . import arguments
from .correct_pose import MIMETIC_OT_correct_pose, MIMETIC_OT_drag_pose
from .correct_value import MIMETIC_OT_correct_value
from .correcting import FRAME, REACH, Correcting
from .dragging import Dragging


class MIMETIC_OT_pin_skin(Dragging, Operator):
    """Drag any place of the captured face to where it belongs in this frame"""

    bl_idname = "mimetic.pin_skin"
    bl_label = "Pin Skin"
    hint = "Drag a place of the face   |   Esc cancels"

    grab: FloatVectorProperty(
        name="From", size=2, description="Pixel of the footage at which the skin is seen"
    )
    to: FloatVectorProperty(
        name="To", size=2, description="Pixel of the footage at which it belongs"
    )
    std: FloatProperty(
        name="Deviation",
        default=1.0,
        min=0.01,
        soft_max=20.0,
        description="Standard deviation in pixels: how surely it belongs there",
    )
    reach: REACH

    def change(self, context, earlier, frame):
        board = corrections.board(context)
        pin = board.grabbed(earlier, frame, tuple(self.grab), self.std)
        return board.with_pin(earlier, frame, pin, tuple(self.to), self.reach)

    def grab_at(self, pixel):
        self.grab = self.to = pixel

    def drag_to(self, pixel):
        self.to = pixel


class MIMETIC_OT_delete_correction(Correcting, Operator):
    """Delete corrections of this frame; Refine takes back what they did"""

    bl_idname = "mimetic.delete_correction"
    bl_label = "Delete Correction"

    what: StringProperty(
        name="What",
        options={"SKIP_SAVE"},
        description="A value's name, pose, or pin 1 and so on; empty: all that the frame has",
    )

    def change(self, context, earlier, frame):
        return native.correcting().without(earlier, frame, self.what)


class MIMETIC_OT_show_correction(Greyed, Operator):
    """Go to a corrected frame"""

    bl_idname = "mimetic.show_correction"
    bl_label = "Show Correction"
    bl_options = {"INTERNAL"}

    frame: FRAME

    obstacle = staticmethod(scene_in.no_clip)

    def execute(self, context):
        frame = self.frame or scene_in.shown_frame(context)
        context.scene.frame_current = scene_in.scene_frame(scene_in.clip_of(context), frame)
        return outcome.finished(self, context, "", frame=frame)


class MIMETIC_OT_refine(Job, Operator):
    """Solve the frames around corrected ones again, as a new take; Esc keeps the one there is"""

    bl_idname = "mimetic.refine"
    bl_label = "Refine"
    bl_options = {"UNDO"}
    needs_object_mode = False
    obstacle = staticmethod(corrections.no_corrections)

    direction: EnumProperty(
        name="Direction",
        items=(
            ("BOTH", "Both", "Frames before and after corrected ones"),
            ("FORWARD", "Forward", "No frame before the first corrected one"),
            ("BACKWARD", "Backward", "No frame after the last corrected one"),
        ),
        description="Which frames beside corrected ones change",
        options={"SKIP_SAVE"},
    )
    frame_first: IntProperty(
        name="First", min=0, options={"SKIP_SAVE"}, description="Footage frame; 0: as far as needed"
    )
    frame_last: IntProperty(
        name="Last", min=0, options={"SKIP_SAVE"}, description="Footage frame; 0: as far as needed"
    )
    filepath: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
        description="File to write (.npz); empty: beside the .blend, a new one for each take",
    )

    @classmethod
    def subject(cls, context):
        return clips.name_of(scene_in.clip_of(context))

    def read(self, context):
        clip = scene_in.clip_of(context)
        new = takes.new_take(clip.name, self.filepath)
        frames = (self.frame_first or None, self.frame_last or None)
        arguments.check_order(*frames)
        return scene_in.take(context), corrections.of_clip(clip), frames, self.direction, new

    def work(self, inputs, progress):
        take, entries, frames, direction, new = inputs
        performance = takes.load(take)
        kept = native.correcting().within(entries, performance)
        is_stopped = False

        def show(fraction, text):
            nonlocal is_stopped
            is_stopped = not progress(fraction, text)
            return not is_stopped

        refined = native.correcting().refined(performance, kept, frames, direction.lower(), show)
        if is_stopped:
            return None
        path, remarks = takes.save(refined, new)
        frames = [entry.frame for entry in kept]
        if num_left := len(entries) - len(kept):
            text = rpt_("{count} more are of frames that this take does not have")
            if num_left == 1:
                text = rpt_("1 more is of a frame that this take does not have")
            remarks = [text.format(count=num_left), *remarks]
        facts = {"clip": take.clip_name, "performance": path, "frames": frames}
        return (
            facts,
            native.take_facts().facts_of(refined),
            [
                plural.one_or_many(
                    len(frames),
                    rpt_("Refined about 1 corrected frame"),
                    rpt_("Refined about {count} corrected frames"),
                ).format(count=len(frames)),
                *remarks,
            ],
        )

    def write(self, context, result):
        self.facts, of_take, remarks = result
        clip_name, path = self.facts["clip"], self.facts["performance"]
        editors.redraw(*editors.OF_TAKES)
        gone = captured_takes.keep_for(context.scene, clip_name, path, of_take)
        return "; ".join([*remarks, *gone])


CLASSES = (
    MIMETIC_OT_pin_skin,
    MIMETIC_OT_correct_value,
    MIMETIC_OT_correct_pose,
    MIMETIC_OT_drag_pose,
    MIMETIC_OT_delete_correction,
    MIMETIC_OT_show_correction,
    MIMETIC_OT_refine,
)
