# SPDX-License-Identifier: GPL-3.0-or-later
"""Edits of the face's curves: of all, of a group, of what is selected in the Graph Editor."""

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty, FloatProperty, StringProperty
from bpy.types import Operator

from .. import editors, native, outcome, plural, scene_in, scene_out, targets
from ..greyed import Greyed
from .curve_options import MIRRORS
from .key_options import FewKeysOptions


def _groups(self, context, text) -> list[str]:
    face = scene_in.face_of(context)
    curves = scene_out.face_curves.of(face) if face else []
    return list(dict.fromkeys(row.group for row in curves))


class OnCurves(Greyed):
    """Mixin. Subclasses give `edit(context, face, chosen)`: the line for the user, and facts."""

    on: EnumProperty(
        name="On",
        items=(
            ("ALL", "All", "Every curve of the group, or of the face"),
            ("CURVES", "Selected Curves", "Curves that are selected in the Graph Editor"),
            ("KEYS", "Selected Keys", "Keys that are selected in the Graph Editor"),
        ),
        description="What of the face's curves is meant; locked ones never are",
    )
    group: StringProperty(
        name="Group", search=_groups, description="Curves of one group alone; empty: of all"
    )
    side: EnumProperty(
        name="Side",
        items=(
            ("BOTH", "Both", "Both sides, and what lies in the middle"),
            ("LEFT", "Left", "The subject's left alone"),
            ("RIGHT", "Right", "The subject's right alone"),
        ),
        description="Curves of one side alone",
    )

    takes_rest = False  # contact and detail too

    obstacle = staticmethod(targets.no_curves)

    def execute(self, context):
        face, scene = scene_in.face_of(context), context.scene
        choice = scene_out.face_curves.Choice(self.on, self.group, self.side, self.takes_rest)
        try:
            chosen = scene_out.face_curves.choose(face, choice)
            message, facts = self.edit(context, face, chosen)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)  # plays them
        editors.redraw()
        names = [*scene_out.face_curves.sampled(face, choice), *self.sampled_too(face, chosen)]
        if names:
            message += f"; {scene_out.face_curves.sampled_text(list(dict.fromkeys(names)))}"
        facts = {"object": face.name, "num_curves": len(chosen), **facts}
        return outcome.finished(self, context, message, **facts)

    def sampled_too(self, face, chosen) -> list[str]:
        """What else would be edited, but has samples instead of keys."""
        return []


def _count(chosen) -> str:
    count = len(chosen)
    return plural.one_or_many(count, rpt_("1 curve"), rpt_("{count} curves")).format(count=count)


class MIMETIC_OT_reduce_keys(FewKeysOptions, OnCurves, Operator):
    """Replace keys of the face's curves that are one a frame by few with handles, where something
    changes"""

    bl_idname = "mimetic.reduce_keys"
    bl_label = "Few Keys"
    bl_options = {"REGISTER", "UNDO"}

    takes_rest = True

    def edit(self, context, face, chosen):
        summary = scene_out.few_keys.reduce(chosen, self.tolerance, self.use_phases)
        message = rpt_("{after} keys instead of {before}, within {error:.3f}").format(
            after=summary.keys_after, before=summary.keys_before, error=summary.error
        )
        if not summary.keys_before:
            message = rpt_("These curves have few keys already: none is one a frame")
        facts = {"num_keys": summary.keys_after, "num_keys_before": summary.keys_before}
        return message, {**facts, "error": float(summary.error)}


class MIMETIC_OT_smooth_curves(OnCurves, Operator):
    """Take off what changes faster than a time; slow motion, and where keys lie, stays"""

    bl_idname = "mimetic.smooth_curves"
    bl_label = "Smooth"
    bl_options = {"REGISTER", "UNDO"}

    seconds: FloatProperty(
        name="Over",
        default=0.08,
        min=0.0,
        max=10.0,
        soft_max=1.0,
        precision=3,
        step=1,
        description="Seconds of the scene that neighbours weigh in by, as a standard deviation: "
        "the same at every frame rate",
    )
    use_lids_and_gaze: BoolProperty(
        name="Lids and Gaze Too",
        description="Smooth them where all curves are meant, too: blinks and jumps of the eyes are "
        "short and lose height",
    )
    takes_rest = True

    def edit(self, context, face, chosen):
        if self.on == "ALL" and not self.group and not self.use_lids_and_gaze:
            gaze, is_lid = native.gaze_shapes().GAZE_GROUP, native.curve_settings().is_lid
            chosen = [c for c in chosen if c.of.group != gaze and not is_lid(c.of.shape)]
        rate = scene_in.timing(context.scene, None).scene_rate
        farthest = scene_out.curve_edits.smooth(chosen, self.seconds * rate)
        text = rpt_("{curves} smoothed; keys moved by up to {farthest:.3f}")
        if farthest is None:
            text = rpt_("{curves} smoothed")
        message = text.format(curves=_count(chosen), farthest=farthest)
        return message, {"error": farthest, "num_curves": len(chosen)}


class WithinLimits:
    """Mixin of edits that may go beyond what a muscle can do."""

    use_limits: BoolProperty(
        name="Keep Limits",
        default=True,
        description="Keys stay within what each slider can do; Blender cuts off what is beyond",
    )

    def scaled(self, chosen) -> list:
        """Without what is no value by itself: eyes that shape keys turn."""
        turns = native.gaze_shapes().TURNS
        values = [one for one in chosen if one.of.shape[:-2] not in turns]
        if not self.group:
            gaze = native.gaze_shapes().GAZE_GROUP
            values = [one for one in values if one.of.group != gaze]
        if not values:
            raise native.invalid_input(
                "Eyes that shape keys turn cannot be scaled curve by curve: bake to the control "
                "object, and edit its gaze"
            )
        return values

    def told(self, values, what: str, beyond: int):
        message = f"{_count(values)} {what}"
        if beyond:
            message += plural.one_or_many(
                beyond,
                rpt_("; 1 key kept within its limits"),
                rpt_("; {count} keys kept within their limits"),
            ).format(count=beyond)
        return message, {"num_curves": len(values), "num_keys_limited": beyond}


class MIMETIC_OT_exaggerate_curves(WithinLimits, OnCurves, Operator):
    """Make the expression larger or smaller than the actor's, of all muscles or of a group"""

    bl_idname = "mimetic.exaggerate_curves"
    bl_label = "Exaggerate"
    bl_options = {"REGISTER", "UNDO"}

    factor: FloatProperty(
        name="Factor",
        default=1.25,
        min=0.0,
        max=10.0,
        soft_max=3.0,
        description="1 leaves curves as they are, 0 holds them still",
    )
    about: EnumProperty(
        name="About",
        items=(
            ("REST", "Rest", "0, the character's face at rest, stays"),
            ("FRAME", "This Frame", "What the face does in the current frame stays"),
        ),
        description="The face that stays as it is whatever the factor",
    )

    def edit(self, context, face, chosen):
        at = context.scene.frame_current_final if self.about == "FRAME" else None
        values = self.scaled(chosen)
        beyond = scene_out.curve_edits.exaggerate(values, self.factor, at, self.use_limits)
        return self.told(values, rpt_("times {factor:.3g}").format(factor=self.factor), beyond)


class MIMETIC_OT_offset_curves(WithinLimits, OnCurves, Operator):
    """Raise or lower curves, or make the face of the current frame the character's at rest"""

    bl_idname = "mimetic.offset_curves"
    bl_label = "Offset"
    bl_options = {"REGISTER", "UNDO"}

    by: EnumProperty(
        name="By",
        items=(
            ("AMOUNT", "Amount", "The same amount everywhere"),
            (
                "NEUTRAL",
                "Neutral Here",
                "Less what each curve is in the current frame, where the face is at rest then",
            ),
        ),
        description="How far curves are moved",
    )
    amount: FloatProperty(
        name="Amount",
        default=0.1,
        min=-2.0,
        max=2.0,
        precision=3,
        description="Of which 1 is a full activation",
    )

    def edit(self, context, face, chosen):
        edits, values = scene_out.curve_edits, self.scaled(chosen)
        if self.by == "NEUTRAL":
            at = context.scene.frame_current_final
            beyond = edits.set_neutral(values, at, self.use_limits)
            return self.told(values, rpt_("at rest in frame {frame:.6g}").format(frame=at), beyond)
        beyond = edits.shift(values, self.amount, self.use_limits)
        return self.told(values, rpt_("moved by {amount:.3g}").format(amount=self.amount), beyond)


class MIMETIC_OT_mirror_curves(OnCurves, Operator):
    """Exchange what the two sides do, or make them do the same"""

    bl_idname = "mimetic.mirror_curves"
    bl_label = "Mirror"
    bl_options = {"REGISTER", "UNDO"}

    how: EnumProperty(
        name="How",
        items=MIRRORS,
        description="What the sides do afterwards",
    )
    share: FloatProperty(
        name="Share",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        description="From what each side does by itself, 0, to that, 1",
    )

    def edit(self, context, face, chosen):
        curves = scene_out.face_curves.of(face)
        if self.on == "KEYS":
            chosen = [one for one in chosen if one.is_chosen.all()]
        if not chosen:
            raise native.invalid_input("Whole curves are mirrored: select all keys of some")
        count = scene_out.curve_edits.mirror(chosen, curves, self.how, self.share)
        return rpt_("{count} curves mirrored").format(count=count), {"num_curves": count}

    def sampled_too(self, face, chosen):
        return scene_out.curve_edits.sampled_twins(chosen, scene_out.face_curves.of(face))


class MIMETIC_OT_retime_curves(OnCurves, Operator):
    """Play the face slower, faster or later, the head with it; with selected keys, between the
    first and the last of them, and what comes after moves along"""

    bl_idname = "mimetic.retime_curves"
    bl_label = "Retime"
    bl_options = {"REGISTER", "UNDO"}

    factor: FloatProperty(
        name="Duration",
        default=1.0,
        min=0.01,
        max=100.0,
        soft_min=0.1,
        soft_max=10.0,
        description="Factor of the time it takes: 2 takes twice as long, at half the speed",
    )
    frames_later: FloatProperty(
        name="Later", default=0.0, description="Scene frames by which all of it is moved"
    )
    use_head: BoolProperty(
        name="Head Too",
        default=True,
        description="The head's own motion goes along, unless a group or a side is chosen",
    )
    takes_rest = True

    def edit(self, context, face, chosen):
        edits = scene_out.curve_edits
        first, last = edits.span(chosen)
        curves = edits.curves_to_retime(face, chosen, self._with_head)
        edits.retime(curves, first, last, self.factor, self.frames_later)
        self._take_along(context.scene, face, curves, first, last)
        ends = edits.ends(curves)
        message = rpt_("{num_curves} curves from frame {first:.6g} to {last:.6g}").format(
            num_curves=len(curves), first=ends[0], last=ends[1]
        )
        return message, {"num_curves": len(curves), "scene_frames": list(ends)}

    @property
    def _with_head(self) -> bool:
        return self.use_head and not self.group and self.side == "BOTH"

    def sampled_too(self, face, chosen):
        curves = scene_out.face_curves.head_curves(face) if self._with_head else []
        is_left = any(map(scene_out.face_curves.has_samples, curves))
        return [rpt_("the head")] if is_left else []

    def _take_along(self, scene, face, curves, first: float, last: float) -> None:
        """Lost ranges and error bars of the take that plays, where the whole face is retimed."""
        takes, edits, markers = scene_out.take_list, scene_out.curve_edits, scene_out.lost_markers
        row = takes.playing(face)
        if row is None or not scene_out.face_curves.are_all(face, curves):
            return
        like = first, last, self.factor, self.frames_later
        takes.retime(row, lambda frames: edits.retimed_frames(frames, *like))
        if markers.ours(scene):
            markers.show(scene, row)


CLASSES = (
    MIMETIC_OT_reduce_keys,
    MIMETIC_OT_smooth_curves,
    MIMETIC_OT_exaggerate_curves,
    MIMETIC_OT_offset_curves,
    MIMETIC_OT_mirror_curves,
    MIMETIC_OT_retime_curves,
)
