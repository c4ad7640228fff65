# SPDX-License-Identifier: GPL-3.0-or-later
"""Jaw, lids, lips, gaze or a muscle stated in a frame, by a slider in the value's own unit."""

import math

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import FloatProperty, StringProperty
from bpy.types import Operator

from .. import corrections, native, outcome, scene_in, shown_take
from .correcting import REACH, Correcting

FAR_GAZE = math.radians(50.0)


def _slider(limits: tuple[float, float], soft: tuple[float, float], unit: float = 1.0, **settings):
    """The operator's `value`, in a unit of Blender's: `unit` times it."""

    def get(self) -> float:
        return self.value * unit

    def put(self, value: float) -> None:
        self.value = value / unit

    return FloatProperty(
        name="Value",
        min=limits[0],
        max=limits[1],
        soft_min=soft[0],
        soft_max=soft[1],
        get=get,
        set=put,
        options={"HIDDEN", "SKIP_SAVE"},
        **settings,
    )


class ValueSliders:
    """Mixin of an operator with `value`: a slider of it for each kind of `correcting.kind_of`."""

    as_share: _slider(
        (-1.0, 1.0),
        (0.0, 1.0),
        subtype="FACTOR",
        precision=3,
        description="0: at rest, 1: in full",
    )
    as_signed: _slider(
        (-1.0, 1.0),
        (-1.0, 1.0),
        subtype="FACTOR",
        precision=3,
        description="0: at rest, 1: in full, below 0 the other way: a lid that is wide open",
    )
    as_closing: _slider(
        (-1.6, 1.0),
        (-1.6, 1.0),
        subtype="FACTOR",
        precision=3,
        description="0: at rest, 1: pressed to the slit, below 0 off it",
    )
    as_angle: _slider(
        (-FAR_GAZE, FAR_GAZE),
        (-FAR_GAZE, FAR_GAZE),
        math.radians(1.0),
        subtype="ANGLE",
        description="Where the eye looks, to the subject's left and up",
    )
    as_gap: _slider(
        (-0.05, 0.1),
        (0.0, 0.03),
        subtype="DISTANCE",
        step=0.01,
        precision=4,
        description="Height between the lips' inner edges; 0: they touch",
    )

    def draw_value(self, layout, name: str) -> None:
        layout.prop(self, f"as_{native.correcting().kind_of(name)}", slider=True)


class MIMETIC_OT_correct_value(ValueSliders, Correcting, Operator):
    """State jaw, lid, lips, gaze or a muscle in this frame"""

    bl_idname = "mimetic.correct_value"
    bl_label = "Correct Value"

    value_name: StringProperty(
        name="Of",
        default="jaw_open",
        search=corrections.value_names,
        description="As the take names it: muscle, articulator, gaze, lip_gap",
    )
    value: FloatProperty(
        name="Value",
        min=-50.0,
        max=50.0,
        step=1,
        precision=3,
        description="What it is in this frame: degrees of a gaze, metres of lip_gap, otherwise 0 "
        "at rest to 1 in full, below 0 the other way",
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
        """From what is stated or was captured: the redo panel's slider moves on from there."""
        performance = shown_take.performance_or_none(context)
        frame = self.frame or scene_in.shown_frame(context)
        correcting = native.correcting()
        if performance is not None and not self.properties.is_property_set("value"):
            try:
                kept = corrections.of_clip(scene_in.clip_of(context))
                at = correcting.value_at(performance, frame, self.value_name, kept)
            except native.known_errors() as error:
                return outcome.cancelled(self, context, str(error))
            self.value = at
            stated = correcting.pinned_at(kept, frame, self.value_name)
            if not self.properties.is_property_set("std"):
                self.std = stated.std if stated else 0.0
        return self.execute(context)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(self, "frame")
        layout.prop(self, "value_name")
        self.draw_value(layout, self.value_name)
        layout.prop(self, "std")
        layout.prop(self, "reach")

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
