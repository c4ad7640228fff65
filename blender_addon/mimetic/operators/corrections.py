# SPDX-License-Identifier: GPL-3.0-or-later
"""Corrections of single frames: pins on the captured skin, values, the head's pose."""

from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)
from bpy.types import Operator

from .. import corrections, editors, native, outcome, scene_in, shown_take, takes
from ..greyed import Greyed
from ..jobs import Job
from . import arguments

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
        editors.redraw("CLIP_EDITOR")
        frames = [entry.frame for entry in now]
        message = rpt_("{operator}: frame {frame}; Refine solves the frames around it").format(
            operator=iface_(self.bl_label, "Operator"), frame=frame
        )
        return outcome.finished(self, context, message, clip=clip.name, frames=frames)


class MIMETIC_OT_pin_skin(Correcting, Operator):
    """Drag any place of the captured face to where it belongs in this frame"""

    bl_idname = "mimetic.pin_skin"
    bl_label = "Pin Skin"

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

    def invoke(self, context, event):
        if reason := scene_in.no_picture(context):
            return outcome.cancelled(self, context, reason)
        try:
            # Read before the first click is to be answered
            self._size = tuple(map(int, corrections.board(context).stored_size))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        self._is_dragging = False
        self._before = corrections.of_clip(scene_in.clip_of(context))
        context.window.cursor_modal_set("CROSSHAIR")
        context.workspace.status_text_set(iface_("Drag a place of the face   |   Esc cancels"))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self._leave(context, False)
        pixel = scene_in.footage_pixel(context, event.mouse_x, event.mouse_y, self._size)
        if event.type == "LEFTMOUSE" and event.value == "PRESS" and pixel is not None:
            self.grab = self.to = pixel
            self._is_dragging = self._show(context)
            return {"RUNNING_MODAL"} if self._is_dragging else self._leave(context, False)
        if self._is_dragging and event.type == "MOUSEMOVE" and pixel is not None:
            self.to = pixel
            self._show(context)
        if self._is_dragging and event.type == "LEFTMOUSE" and event.value == "RELEASE":
            return self._leave(context, True)
        return {"RUNNING_MODAL"} if self._is_dragging else {"PASS_THROUGH"}

    def _show(self, context) -> bool:
        """The pin as it would be now; says whether there is skin where it was grabbed."""
        clip = scene_in.clip_of(context)
        try:
            frame = self.frame or scene_in.shown_frame(context)
            corrections.keep(clip, self.change(context, self._before, frame))
        except native.known_errors() as error:
            self.report({"WARNING"}, str(error))
            return False
        editors.redraw("CLIP_EDITOR")
        return True

    def _leave(self, context, is_kept: bool):
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        corrections.keep(scene_in.clip_of(context), self._before)
        editors.redraw("CLIP_EDITOR")
        return self.execute(context) if is_kept else {"CANCELLED"}

    def cancel(self, context):
        self._leave(context, False)


class MIMETIC_OT_correct_value(Correcting, Operator):
    """State jaw, lid, lips, gaze or a muscle in this frame"""

    bl_idname = "mimetic.correct_value"
    bl_label = "Correct Value"

    value_name: StringProperty(
        name="Of",
        default="jaw_open",
        search=corrections.value_names,
        description="As the take names it: muscle, articulator, gaze in degrees; lip_gap in metres",
    )
    value: FloatProperty(
        name="Value",
        min=-50.0,
        max=50.0,
        step=1,
        precision=3,
        description="What it is in this frame: degrees of a gaze, otherwise from -1 to 1",
    )
    std: FloatProperty(
        name="Deviation",
        min=0.0,
        soft_max=1.0,
        precision=4,
        description="Standard deviation, how surely it has this value; 0: 0.03, of a gap 0.3 mm, "
        "of a gaze 1 degree",
    )
    reach: REACH

    def invoke(self, context, event):
        """From what was captured: the slider in the redo panel moves on from there."""
        performance = shown_take.performance_or_none(context)
        frame = self.frame or scene_in.shown_frame(context)
        if performance is not None and not self.properties.is_property_set("value"):
            try:
                at = native.correcting().value_at(performance, frame, self.value_name)
            except native.known_errors() as error:
                return outcome.cancelled(self, context, str(error))
            self.value = at
        return self.execute(context)

    def change(self, context, earlier, frame):
        performance = shown_take.performance(context)
        performance.index_of(frame)
        if self.value_name not in native.correcting().value_names(performance):
            raise native.invalid_input(
                rpt_("value_name {name}: the take has no such value").format(name=self.value_name)
            )
        return native.correcting().with_value(
            earlier, frame, self.value_name, self.value, self.std, self.reach
        )


class MIMETIC_OT_correct_pose(Correcting, Operator):
    """State the head's pose in this frame, as a turn and a shift of the captured one"""

    bl_idname = "mimetic.correct_pose"
    bl_label = "Correct Pose"

    turn: FloatVectorProperty(
        name="Turn", size=3, description="Degrees about the camera's axes: right, down, forward"
    )
    shift: FloatVectorProperty(
        name="Shift", size=3, precision=4, description="Metres to the right, down, forward"
    )
    reach: REACH

    def change(self, context, earlier, frame):
        performance = shown_take.performance(context)
        return native.correcting().with_turn(
            earlier, performance, frame, list(self.turn), list(self.shift), self.reach
        )


class MIMETIC_OT_delete_correction(Correcting, Operator):
    """Delete all corrections of this frame; Refine takes back what they did"""

    bl_idname = "mimetic.delete_correction"
    bl_label = "Delete Correction"

    def change(self, context, earlier, frame):
        return native.correcting().without_frame(earlier, frame)


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

    def read(self, context):
        clip = scene_in.clip_of(context)
        paths = takes.new_paths(clip.name, self.filepath)
        frames = (self.frame_first or None, self.frame_last or None)
        arguments.check_order(*frames)
        return scene_in.take(context), corrections.of_clip(clip), frames, self.direction, paths

    def work(self, inputs, progress):
        take, entries, frames, direction, paths = inputs
        performance = takes.load(take)
        is_stopped = False

        def show(fraction, text):
            nonlocal is_stopped
            is_stopped = not progress(fraction, text)
            return not is_stopped

        refined = native.correcting().refined(performance, entries, frames, direction.lower(), show)
        if is_stopped:
            return None
        path, remarks = takes.save(refined, *paths)
        frames = [entry.frame for entry in entries]
        facts = {"clip": take.clip_name, "performance": path, "frames": frames}
        return facts, [
            rpt_("Refined about {count} corrected frames").format(count=len(frames)),
            *remarks,
        ]

    def write(self, context, result):
        self.facts, remarks = result
        clip_name, path = self.facts["clip"], self.facts["performance"]
        editors.redraw("CLIP_EDITOR")
        return "; ".join([*remarks, *takes.keep_for(context.scene, clip_name, path)])


CLASSES = (
    MIMETIC_OT_pin_skin,
    MIMETIC_OT_correct_value,
    MIMETIC_OT_correct_pose,
    MIMETIC_OT_delete_correction,
    MIMETIC_OT_show_correction,
    MIMETIC_OT_refine,
)
