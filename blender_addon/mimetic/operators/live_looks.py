# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks of a person's face: listed, kept while a live session shows them, saved as a set."""

import json

from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import EnumProperty, IntProperty, StringProperty
from bpy.types import Operator

from .. import editors, live, live_looks, look_settings, native, outcome, scene_in, scene_out
from ..greyed import Greyed
from ..look_settings import MimeticLook
from . import arguments
from .chosen_expression import chosen

NO_LOOK = "Press Add Look first: the list has none"
OWN = "OWN"
_items: list = []  # Blender keeps no copy of a callback's texts


def _usual(self, context) -> list:
    names = [(name, name.capitalize(), "") for name in native.puppet("usual_looks").USUAL_LOOKS]
    _items[:] = [(OWN, "Of Your Own", "Named in the list"), *names]
    return _items


class MIMETIC_OT_add_look(Greyed, Operator):
    """Add a look to teach: a usual one by its name, or one of your own"""

    bl_idname = "mimetic.add_look"
    bl_label = "Add Look"
    bl_options = {"REGISTER", "UNDO"}

    look: EnumProperty(name="Look", items=_usual, description="Which one")
    name: StringProperty(
        name="Name", default="Look", options={"SKIP_SAVE"}, description="Of one of your own"
    )
    parts: arguments.like(MimeticLook, "parts")
    state: arguments.like(MimeticLook, "state")
    expression: StringProperty(name="Expression", description="Name of a kept one's action")
    frame: arguments.like(MimeticLook, "frame")

    @classmethod
    def obstacle(cls, context):
        return native.problem()

    def execute(self, context):
        settings = context.scene.mimetic.live
        name = self.name.strip() if self.look == OWN else self.look
        if name in settings.looks:
            message = rpt_("There is a look {name} already").format(name=name)
            return outcome.cancelled(self, context, message)
        try:
            action = chosen(context, self.expression) if self.expression else None
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        look = settings.looks.add()
        look.name, look.state, look.frame, look.expression = name, self.state, self.frame, action
        usual = native.puppet("usual_looks").USUAL_LOOKS.get(name, ())
        look.parts = self.parts or {part.upper() for part in usual}
        settings.active_look = len(settings.looks) - 1
        message = rpt_("{name} is listed").format(name=name)
        return outcome.finished(self, context, message, look=name)


class MIMETIC_OT_add_usual_looks(Greyed, Operator):
    """Add the usual looks to the list that it has none of yet: at rest, a smile, surprise, brows, \
eyes and mouth"""

    bl_idname = "mimetic.add_usual_looks"
    bl_label = "Add Usual Looks"
    bl_options = {"UNDO"}  # nothing to set, and greyed out once it was pressed

    @classmethod
    def obstacle(cls, context):
        if reason := native.problem():
            return reason
        listed = context.scene.mimetic.live.looks
        if all(name in listed for name in native.puppet("usual_looks").USUAL_LOOKS):
            return "The list has all usual looks"
        return ""

    def execute(self, context):
        settings = context.scene.mimetic.live
        missing = {
            name: parts
            for name, parts in native.puppet("usual_looks").USUAL_LOOKS.items()
            if name not in settings.looks
        }
        for name, parts in missing.items():
            look = settings.looks.add()
            look.name, look.parts = name, {part.upper() for part in parts}
        settings.active_look = len(settings.looks) - len(missing)
        message = rpt_("{count} looks are listed").format(count=len(settings.looks))
        return outcome.finished(self, context, message, looks=list(missing))


class OfLook(Greyed):
    """Mixin of operators on the chosen look; subclasses give `look_obstacle(context, look)`."""

    @classmethod
    def obstacle(cls, context):
        if reason := native.problem():
            return reason
        look = live_looks.chosen(context.scene.mimetic.live)
        return NO_LOOK if look is None else cls.look_obstacle(context, look)

    @classmethod
    def look_obstacle(cls, context, look) -> str:
        return ""


class MIMETIC_OT_remove_look(OfLook, Operator):
    """Take the chosen look off the list; a set that was saved keeps it"""

    bl_idname = "mimetic.remove_look"
    bl_label = "Remove Look"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        settings = context.scene.mimetic.live
        name, i = live_looks.chosen(settings).name, settings.active_look
        settings.looks.remove(i)
        settings.active_look = max(0, min(i, len(settings.looks) - 1))
        message = rpt_("{name} is off the list").format(name=name)
        return outcome.finished(self, context, message, look=name)


class MIMETIC_OT_take_sliders(OfLook, Operator):
    """Have the chosen look drive what the face's sliders are at now"""

    bl_idname = "mimetic.take_sliders"
    bl_label = "Take Sliders"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def look_obstacle(cls, context, look) -> str:
        if live.active:
            return "The live session moves the sliders: stop it first"
        return scene_in.no_sliders(context)

    def execute(self, context):
        look, face = live_looks.chosen(context.scene.mimetic.live), scene_in.face_of(context)
        values = scene_out.expressions.shape_values(face)
        look.sliders, look.state = json.dumps(values), "SLIDERS"
        message = rpt_("{name} drives {count} sliders of {face}").format(
            name=look.name, count=len(values), face=face.name
        )
        return outcome.finished(self, context, message, look=look.name, values=values)


class MIMETIC_OT_keep_look(OfLook, Operator):
    """Keep the chosen look as the next half second shows it; held before, it is kept anew"""

    bl_idname = "mimetic.keep_look"
    bl_label = "Keep Look"

    index: IntProperty(
        name="Look",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
        description="Its place in the list, from 0; -1 is the chosen one",
    )

    @classmethod
    def look_obstacle(cls, context, look) -> str:
        if live.active is None:
            return "Press Start Live first: no session shows the face"
        if live.active.thread.keeper is None:
            return "Stop the session, tick Teach and start it again: this one does not teach"
        if reason := look_settings.obstacle(look):
            return reason
        if not live.active.thread.keeper.is_ready:
            return "Look into the camera at rest first, until the head is known"
        return ""

    def execute(self, context):
        settings = context.scene.mimetic.live
        if 0 <= self.index < len(settings.looks):
            settings.active_look = self.index
        look = live_looks.chosen(settings)
        if reason := look_settings.obstacle(look):
            return outcome.cancelled(self, context, reason)
        try:
            live.active.thread.keeper.ask(look_settings.as_look(look))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        name = look.name
        live_looks.choose_next(settings)
        editors.redraw("VIEW_3D")
        message = rpt_("Hold it: {name}").format(name=name)
        return outcome.finished(self, context, message, look=name)


class MIMETIC_OT_save_set(Greyed, Operator):
    """Write the looks that were kept as a taught set, and take it for the sessions to come"""

    bl_idname = "mimetic.save_set"
    bl_label = "Save Set"
    bl_options = {"UNDO"}  # a redo panel would write files as one types

    filepath: StringProperty(
        name="File",
        subtype="FILE_PATH",
        description="Of the set, .npz; empty: a new one beside the .blend",
    )

    @classmethod
    def obstacle(cls, context):
        if reason := native.problem():
            return reason
        if not live_looks.kept():
            return "Keep a look first: tick Teach, press Start Live, then Keep Look"
        return ""

    def execute(self, context):
        settings = context.scene.mimetic.live
        try:
            path, lines, facts = live_looks.save(self.filepath)
        except (*native.known_errors(), OSError) as error:
            return outcome.cancelled(self, context, str(error))
        settings.taught_set, settings.advice = path, "\n".join(lines)
        message = rpt_("{count} looks in {path}; {advice}").format(
            count=len(facts["looks"]), path=path, advice=lines[0]
        )
        return outcome.finished(self, context, message, advice=lines, **facts)


CLASSES = (
    MIMETIC_OT_add_look,
    MIMETIC_OT_add_usual_looks,
    MIMETIC_OT_remove_look,
    MIMETIC_OT_take_sliders,
    MIMETIC_OT_keep_look,
    MIMETIC_OT_save_set,
)
