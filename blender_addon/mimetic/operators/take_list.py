# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes of the active face or character: which plays, two at once, and where the face was lost."""

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import FloatProperty, StringProperty
from bpy.types import Operator

from .. import editors, native, outcome, plural, scene_in, scene_out, targets
from ..greyed import Greyed


def _names(self, context, text) -> list[str]:
    obj = targets.take_owner(context)
    return [row.name for row in obj.mimetic.takes] if obj else []


def _with_remarks(message: str, obj, *rows) -> str:
    takes = scene_out.take_list
    return "; ".join(filter(None, (message, takes.gone_keys(obj, *rows), takes.shared(obj))))


class OnTake(Greyed):
    """Mixin. Subclasses give `use(context, obj, row)`: the line for the user, and facts."""

    take: StringProperty(
        name="Take", search=_names, description="A take of the list; empty: the row that is shown"
    )

    obstacle = staticmethod(targets.no_take_list)

    def execute(self, context):
        obj, scene = targets.take_owner(context), context.scene
        try:
            row = scene_out.take_list.find(obj, self.take)
            facts = {"object": obj.name, "take": row.name}
            message, more = self.use(context, obj, row)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        scene.frame_set(scene.frame_current, subframe=scene.frame_subframe)
        editors.redraw()
        return outcome.finished(self, context, message, **facts, **more)


class MIMETIC_OT_play_take(OnTake, Operator):
    """Have a take move the face, alone; the one that does now stays in the list"""

    bl_idname = "mimetic.play_take"
    bl_label = "Play Take"
    bl_options = {"REGISTER", "UNDO"}

    def use(self, context, obj, row):
        is_whole = scene_out.take_list.play(obj, row)
        if scene_out.lost_markers.ours(context.scene):
            scene_out.lost_markers.show(context.scene, row)
        message = rpt_("{take} plays on {name}").format(take=row.name, name=obj.name)
        if not is_whole:
            message += rpt_(
                "; contact and detail were made for a later bake and rest: bake it again"
            )
        return _with_remarks(message, obj, row), {}


class MIMETIC_OT_remove_take(OnTake, Operator):
    """Take a take off the list, and its actions out of the file where nothing else uses them"""

    bl_idname = "mimetic.remove_take"
    bl_label = "Remove Take"
    bl_options = {"REGISTER", "UNDO"}

    def use(self, context, obj, row):
        name, has_actions = row.name, any(part.action for part in row.parts)
        actions = scene_out.take_list.remove(obj, row)
        message = rpt_("{name} is removed").format(name=name)
        if actions:
            message += rpt_(", with {actions}").format(actions=", ".join(actions))
        elif has_actions:
            message += rpt_("; its actions are used elsewhere")
        return _with_remarks(message, obj), {"actions": actions}


class MIMETIC_OT_compare_take(OnTake, Operator):
    """Put a copy of the face beside it that plays a take at the same time; delete it as any
    object"""

    bl_idname = "mimetic.compare_take"
    bl_label = "Compare Side by Side"
    bl_options = {"REGISTER", "UNDO"}

    def use(self, context, obj, row):
        name = row.name
        scene_out.take_list.leave_tweak_mode(obj)  # or the copy would be in it, too
        twin = scene_out.take_comparison.stand_beside(context.scene, obj, row)
        message = rpt_("{copy} plays {take} beside {original}").format(
            copy=twin.name, take=name, original=obj.name
        )
        message = _with_remarks(message, twin, twin.mimetic.takes[name])
        return message, {"copy": twin.name}


class MIMETIC_OT_blend_takes(OnTake, Operator):
    """Play a take over the one that plays now, as strips of the NLA, by an influence"""

    bl_idname = "mimetic.blend_takes"
    bl_label = "Blend In"
    bl_options = {"REGISTER", "UNDO"}

    influence: FloatProperty(
        name="Influence",
        default=0.5,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        description="From the take that plays, 0, to the one blended in, 1; it can be keyed in the "
        "NLA",
    )
    over: StringProperty(
        name="Over", search=_names, description="The take below; empty: the one that plays"
    )

    def use(self, context, obj, row):
        takes = scene_out.take_list
        under = takes.find(obj, self.over) if self.over else takes.playing(obj)
        if under is None:
            raise native.invalid_input(
                rpt_("No take plays on {name}: play one first, or name it").format(name=obj.name)
            )
        takes.blend(obj, under, row, self.influence)
        message = rpt_("{take} over {other} at {influence:.0%}").format(
            take=row.name, other=under.name, influence=self.influence
        )
        return _with_remarks(message, obj, under, row), {"over": under.name}


class MIMETIC_OT_mark_lost(OnTake, Operator):
    """Mark in the timeline where the face of a take was lost and is held, instead of marks of
    another take"""

    bl_idname = "mimetic.mark_lost"
    bl_label = "Mark Lost Frames"
    bl_options = {"REGISTER", "UNDO"}

    def use(self, context, obj, row):
        count = scene_out.lost_markers.show(context.scene, row)
        if not count:
            message = rpt_("{take} was never lost")
        elif count == 1:
            message = rpt_("1 lost range of {take} marked")
        else:
            message = rpt_("{count} lost ranges of {take} marked")
        return message.format(take=row.name, count=count), {"num_ranges": count}


class MIMETIC_OT_unmark_lost(Greyed, Operator):
    """Remove the marks of lost frames; markers of your own stay"""

    bl_idname = "mimetic.unmark_lost"
    bl_label = "Remove Marks of Lost Frames"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def obstacle(cls, context):
        return scene_in.no_start()

    def execute(self, context):
        count = scene_out.lost_markers.clear(context.scene)
        if not count:
            return outcome.cancelled(self, context, "No lost frames are marked", "INFO")
        editors.redraw()
        return outcome.finished(self, context, _removed(count))


def _removed(count: int) -> str:
    text = plural.one_or_many(count, rpt_("1 marker removed"), rpt_("{count} markers removed"))
    return text.format(count=count)


CLASSES = (
    MIMETIC_OT_play_take,
    MIMETIC_OT_remove_take,
    MIMETIC_OT_compare_take,
    MIMETIC_OT_blend_takes,
    MIMETIC_OT_mark_lost,
    MIMETIC_OT_unmark_lost,
)
