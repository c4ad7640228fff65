# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.props import BoolProperty, FloatProperty
from bpy.types import Operator

from .. import editors, native, outcome, scene_in, scene_out, targets
from ..greyed import Greyed


class MIMETIC_OT_reduce_keys(Greyed, Operator):
    """Replace the keys of the face's curves by few with handles, where something changes"""

    bl_idname = "mimetic.reduce_keys"
    bl_label = "Few Keys"
    bl_options = {"REGISTER", "UNDO"}

    tolerance: FloatProperty(
        name="Tolerance",
        default=0.02,
        min=0.001,
        max=0.5,
        precision=3,
        description="By how much the curves may change, of which 1 is a full activation",
    )

    use_phases: BoolProperty(
        name="At Phases",
        default=False,
        description="Keys at onset, apex, release and end of each event first",
    )

    @classmethod
    def obstacle(cls, context):
        return native.problem() or targets.no_curves(context)

    def execute(self, context):
        face = scene_in.face_of(context)
        summary = scene_out.few_keys.reduce(face, self.tolerance, self.use_phases)
        message = (
            f"{summary.keys_after} keys instead of {summary.keys_before}, "
            f"within {summary.error:.3f}"
        )
        facts = {"num_keys": summary.keys_after, "num_keys_before": summary.keys_before}
        facts |= {"object": face.name, "error": float(summary.error)}
        editors.redraw()
        return outcome.finished(self, context, message, **facts)


CLASSES = (MIMETIC_OT_reduce_keys,)
