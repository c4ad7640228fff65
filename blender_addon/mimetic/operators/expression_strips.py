# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions in the NLA of a face: one after the other, over each other, and as one."""

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, FloatProperty, StringProperty
from bpy.types import Operator

from .. import native, outcome, plural, scene_in, scene_out, targets
from ..greyed import Greyed
from .chosen_expression import OnFace, chosen


class MIMETIC_OT_sequence_expression(OnFace, Operator):
    """Add an expression to the face's NLA: it begins to move in the current frame"""

    bl_idname = "mimetic.sequence_expression"
    bl_label = "Add Expression Strip"
    bl_options = {"REGISTER", "UNDO"}

    is_mirrored: BoolProperty(name="Mirrored", description="The other side's")
    strength: FloatProperty(
        name="Strength",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        description="What the expression's values are multiplied by",
    )

    def execute(self, context):
        scene, face = context.scene, scene_in.face_of(context)
        rate = scene_in.timing(scene, None).scene_rate
        try:
            action = chosen(context, self.action)
            sequence = scene_out.expression_strips.sequence(
                *(face, action, scene.frame_current, rate), self.is_mirrored, self.strength
            )
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        text = rpt_("{action} from frame {first:.6g} to {last:.6g} on {face}").format(
            action=action.name, first=sequence.first, last=sequence.last, face=face.name
        )
        if sequence.pushed_down:
            text += rpt_("; {name} is a strip under it now").format(name=sequence.pushed_down)
        text += scene_out.expressions.missing_text(face, sequence.missing)
        facts = {"action": action.name, "object": face.name}
        facts["scene_frames"] = [sequence.first, sequence.last]
        return outcome.finished(self, context, text, **facts)


class MIMETIC_OT_compose_expressions(Greyed, Operator):
    """Make one new expression of the face's strips: where several move a muscle the one nearer to
    its peak prevails. The strips are muted"""

    bl_idname = "mimetic.compose_expressions"
    bl_label = "Compose Strips"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(
        name="Name", default="Composition", description="Of the action that the strips become"
    )

    obstacle = staticmethod(targets.no_expression_strips)

    def execute(self, context):
        face = scene_in.face_of(context)
        rate = scene_in.timing(context.scene, None).scene_rate
        strips = scene_out.expression_strips
        count = len(strips.strips_of(face))
        try:
            span = strips.compose(face, self.name, rate)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        frames = [span.first, span.last]
        text = plural.one_or_many(
            count,
            rpt_("1 strip is {name}, from frame {first:.6g} to {last:.6g}"),
            rpt_("{count} strips are {name}, from frame {first:.6g} to {last:.6g}"),
        ).format(count=count, name=self.name, first=span.first, last=span.last)
        return outcome.finished(self, context, text, object=face.name, scene_frames=frames)


CLASSES = (MIMETIC_OT_sequence_expression, MIMETIC_OT_compose_expressions)
