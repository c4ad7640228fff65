# SPDX-License-Identifier: GPL-3.0-or-later
"""The head's pose stated in a frame."""

from bpy.props import EnumProperty, FloatProperty, FloatVectorProperty
from bpy.types import Operator

from .. import corrections, native, outcome, scene_in, shown_take
from .correcting import REACH, Correcting
from .dragging import Dragging


class StatesPose(Correcting):
    """Mixin of operators that state a pose."""

    turn: FloatVectorProperty(
        name="Turn", size=3, description="Degrees about the camera's axes: right, down, forward"
    )
    shift: FloatVectorProperty(
        name="Shift", size=3, precision=4, description="Metres to the right, down, forward"
    )
    rotation_std: FloatProperty(
        name="Deviation of Turn",
        default=0.01,
        min=1e-6,
        soft_min=0.001,
        soft_max=0.2,
        subtype="ANGLE",
        precision=3,
        description="Standard deviation, how surely the head is turned so",
    )
    translation_std: FloatProperty(
        name="Deviation of Shift",
        default=0.002,
        min=1e-6,
        soft_min=0.0001,
        soft_max=0.1,
        subtype="DISTANCE",
        precision=4,
        description="Standard deviation, how surely the head is there",
    )
    reach: REACH

    def begin(self, context) -> None:
        kept = corrections.of_clip(scene_in.clip_of(context))
        frame = self.frame or scene_in.shown_frame(context)
        correcting, performance = native.correcting(), shown_take.performance(context)
        turn, shift = correcting.turn_at(kept, performance, frame)
        self._set_unless_given("turn", turn)
        self._set_unless_given("shift", shift)
        entry = correcting.at_frame(kept, frame)
        if entry is not None and entry.pose is not None:
            for name in ("rotation_std", "translation_std"):
                self._set_unless_given(name, getattr(entry.pose, name))

    def _set_unless_given(self, name: str, value) -> None:
        if not self.properties.is_property_set(name):
            setattr(self, name, value)

    def change(self, context, earlier, frame):
        return native.correcting().with_turn(
            earlier,
            shown_take.performance(context),
            frame,
            list(self.turn),
            list(self.shift),
            self.reach,
            self.rotation_std,
            self.translation_std,
        )


class MIMETIC_OT_correct_pose(StatesPose, Operator):
    """State the head's pose in this frame, as a turn and a shift of the captured one"""

    bl_idname = "mimetic.correct_pose"
    bl_label = "Correct Pose"

    def invoke(self, context, event):
        """From the pose that is stated or was captured."""
        try:
            self.begin(context)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        return self.execute(context)


class MIMETIC_OT_drag_pose(StatesPose, Dragging, Operator):
    """Drag the head to where it belongs in this frame, or turn it"""

    bl_idname = "mimetic.drag_pose"
    bl_label = "Drag Pose"
    hint = "Drag the head   |   G moves, R turns, R again rolls   |   Esc cancels"
    heard = frozenset("GR")
    _from = _to = None  # pixels of the footage, once it is dragged

    mode: EnumProperty(
        name="Drag",
        items=(
            ("MOVE", "Move", "The head goes along, in its distance from the camera"),
            ("TURN", "Turn", "The face goes along, the head turns about its middle"),
            ("ROLL", "Roll", "The head turns about the view's axis"),
        ),
        options={"HIDDEN", "SKIP_SAVE"},
        description="What a drag does to the head",
    )

    def prepare(self, context):
        self.begin(context)
        frame = self.frame or scene_in.shown_frame(context)
        performance = shown_take.performance(context)
        self._drag = native.correcting().PoseDrag(
            performance, frame, list(self.turn), list(self.shift)
        )

    def press_key(self, kind):
        self.mode = "MOVE" if kind == "G" else "ROLL" if self.mode == "TURN" else "TURN"
        self._follow()

    def grab_at(self, pixel):
        self._from = self._to = pixel

    def drag_to(self, pixel):
        self._to = pixel
        self._follow()

    def _follow(self) -> None:
        if self._from is not None:
            mode = self.mode.lower()
            self.turn, self.shift = self._drag.dragged(self._from, self._to, mode)
