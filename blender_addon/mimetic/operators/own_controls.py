# SPDX-License-Identifier: GPL-3.0-or-later
"""A performance on a character's own shape keys or bones, and the table of how each is driven."""

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty, StringProperty
from bpy.types import Operator

from .. import (
    control_preview,
    control_rows,
    editors,
    native,
    outcome,
    playback,
    plural,
    scene_in,
    scene_out,
    takes,
    targets,
    writable,
)
from ..greyed import Greyed
from ..jobs import Job
from ..named_file import named_file
from ..scene_out import face_bones, own_controls, own_keys
from .curve_options import CurveOptions
from .key_options import KeyOptions
from .sections import InSections
from .take_options import TakeOptions

MANY = 0.98  # of the work: fitting


def surface_of(context, character: bpy.types.Object):
    """What a character's own keys, or its face's bones, do."""
    if character.type == "ARMATURE":
        return face_bones.surface(context.scene, character)
    return own_keys.surface(character)


def ranges_of(character: bpy.types.Object) -> dict[str, list[float]]:
    """The least and greatest values of a character's own controls, by name."""
    return (face_bones if character.type == "ARMATURE" else own_keys).ranges(character)


def _write_rows(character: bpy.types.Object, rows, remarks=None) -> None:
    with control_preview.quiet():
        control_rows.write(character, rows, remarks)


class OnControls(Greyed):
    """Mixin of operators on the active object's table of controls."""

    obstacle = staticmethod(targets.no_control_table)


class Fitting(OnControls, Job):
    """Mixin of jobs that fit the active character's controls to the take that buttons mean."""

    bl_options = {"REGISTER", "UNDO"}

    def read(self, context):
        character = scene_in.active(context)
        if character.type == "ARMATURE":
            control_preview.end()  # the rig is measured as it was
        before = [] if self.is_reset() else control_rows.rows_of(character)
        rows = native.controls().refitted(before, ranges_of(character))
        has_take = not scene_in.no_take(context, "Capture")
        take = scene_in.take(context) if has_take else None
        surface = surface_of(context, character) if has_take else None
        is_rig = character.type == "ARMATURE"
        options = native.bone_channels().nearest_surface() if is_rig else None
        return character.name, surface, rows, take, options, self.curve_settings()

    def write_rows(self, character, rows, played) -> str:
        """Makes these rows the table; edited ones of controls that are gone stay after them, and
        what to say of these is returned."""
        before = [] if self.is_reset() else control_rows.rows_of(character)
        waiting = native.controls().waiting(before, {row.control: row for row in rows})
        remarks = native.playing().remarks(rows, played)
        remarks |= {row.control: rpt_("no control of this name now") for row in waiting}
        _write_rows(character, [*rows, *waiting], remarks)
        if not waiting:
            return ""
        names = ", ".join(row.control for row in waiting)
        return rpt_("; no controls now, whose edited rows wait: {names}").format(names=names)

    def curve_settings(self):
        """Of a fit: curves as captured."""
        return native.curve_settings().CurveSettings()

    def is_reset(self) -> bool:
        return False

    def work(self, inputs, progress):
        name, surface, rows, take, options, settings = inputs
        if take is None:
            return name, rows, None, None, None
        if not progress(0.0, "reading the performance"):
            return None
        performance = native.curve_settings().edited(takes.load(take), settings)
        if not progress(0.2, "fitting the controls"):
            return None
        played = native.playing().play(performance, surface, rows, options)
        if not progress(MANY, "writing"):
            return None
        return name, rows, played, performance, take


class MIMETIC_OT_fit_controls(Fitting, Operator):
    """List the active character's own shape keys, or the bones of its face, and how performances
    drive them, by what its muscles do or by known names; rows that were edited stay"""

    bl_idname = "mimetic.fit_controls"
    bl_label = "Fit Controls"
    obstacle = staticmethod(targets.no_controls)

    reset_edits: BoolProperty(
        name="Reset Edits",
        options={"SKIP_SAVE"},
        description="Put edited rows back to what they were at first, too",
    )

    def is_reset(self) -> bool:
        return self.reset_edits

    def write(self, context, result):
        name, rows, played, _, _ = result
        character = writable.own_object(context.scene, name)
        gone = self.write_rows(character, rows, played)
        self.facts = {"object": name, "num_controls": len(rows)}
        text = plural.one_or_many(
            len(rows), rpt_("{name}: 1 control"), rpt_("{name}: {count} controls")
        )
        message = text.format(name=name, count=len(rows))
        said = f"; {played.summary()}" if played else rpt_("; no performance yet")
        return message + said + gone


class MIMETIC_OT_bake_controls(
    KeyOptions, CurveOptions, TakeOptions, InSections, Fitting, Operator
):
    """Put the performance on the active character's own shape keys, or the bones of its face, and
    the head's motion on the object or the head's bone; actions that were there stay in the file"""

    bl_idname = "mimetic.bake_controls"
    bl_label = "Bake to Character"
    obstacle = staticmethod(targets.no_controls_bake)

    use_head_motion: BoolProperty(
        name="Head Motion", default=True, description="Move the object as the actor's head moves"
    )

    sections = (
        CurveOptions.CURVES,
        KeyOptions.KEYS,
        ("Scene", ("use_head_motion",), True),
        TakeOptions.TAKE,
    )

    def write(self, context, result):
        name, rows, played, performance, take = result
        character = writable.own_object(context.scene, name)
        clip = bpy.data.movieclips.get(take.clip_name)
        action_name = takes.action_name(take, performance)
        before = scene_out.take_list.before_bake(character)
        control_preview.end()
        place = context.scene, performance, action_name, character, played, clip
        keys = self.key_remarks()
        is_rig = character.type == "ARMATURE"
        bake = face_bones.bake if is_rig else own_controls.bake
        summary = bake(*place, self.use_head_motion, *self.few_keys())
        gone = self.write_rows(character, rows, played)
        self.facts = {
            "object": name,
            "num_curves": summary.num_curves,
            "scene_frames": [summary.first, summary.last],
            "driven": [c for c in played.names if c not in played.resting],
            "unmatched": list(played.unmatched),
            "explained": played.explained,
        }
        settings = ", ".join([iface_("own controls"), *keys, *self.curve_remarks()])
        like = performance, action_name, take, clip, settings, before
        message = rpt_("{num_curves} curves from frame {first:.6g} to {last:.6g} on {name}").format(
            num_curves=summary.num_curves, first=summary.first, last=summary.last, name=name
        )
        return f"{message}; {summary.text}{gone}{self.note_take(context, character, *like)}"


class MIMETIC_OT_preview_controls(Fitting, Operator):
    """Show the performance on the active character at the scene's frame as the table has it, while
    rows are edited; nothing is keyed. Again, or Esc, puts the character back"""

    bl_idname = "mimetic.preview_controls"
    bl_label = "Preview"
    bl_options = set()  # shows, and leaves nothing to do again
    obstacle = staticmethod(targets.no_controls_bake)

    def execute(self, context):
        return self._end_preview(context) or super().execute(context)

    def invoke(self, context, event):
        return self._end_preview(context) or super().invoke(context, event)

    def _end_preview(self, context):
        if not control_preview.is_of(scene_in.active(context)):
            return None
        control_preview.end()
        return outcome.finished(self, context, "The character is as it was before")

    def read(self, context):
        clip = scene_in.clip_of(context)
        return *super().read(context), scene_in.timing(context.scene, clip)

    def work(self, inputs, progress):
        name, surface, rows, take, options, settings, clock = inputs
        if not progress(0.0, "reading the performance"):
            return None
        performance = native.curve_settings().edited(takes.load(take), settings)
        if not progress(0.2, "fitting the controls"):
            return None
        frames = scene_in.scene_frames(performance, clock)
        preview = native.playing().ControlPreview(performance, surface, frames, options)
        return (name, rows, preview) if progress(MANY, "showing") else None

    def write(self, context, result):
        name, rows, preview = result
        character = writable.own_object(context.scene, name)
        if not len(character.mimetic.controls):
            control_rows.write(character, rows)
        control_preview.begin(character, preview)
        if context.window is not None and not bpy.app.background:
            bpy.ops.mimetic.leave_preview("INVOKE_DEFAULT")
        self.facts = {"object": name, "num_controls": len(rows)}
        return rpt_("{name} shows the performance; Esc puts it back").format(name=name)


class MIMETIC_OT_leave_preview(Operator):
    """Wait for Esc, which puts the previewed character back"""

    bl_idname = "mimetic.leave_preview"
    bl_label = "Leave Preview"
    bl_options = {"INTERNAL"}

    def invoke(self, context, event):
        self._shown = control_preview.active
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if control_preview.active is not self._shown:
            return {"FINISHED", "PASS_THROUGH"}
        if event.type == "ESC" and event.value == "PRESS" and not playback.is_on():
            control_preview.end()
            editors.redraw("VIEW_3D")
            return {"FINISHED"}
        return {"PASS_THROUGH"}


class MIMETIC_OT_mirror_controls(OnControls, Operator):
    """Give the edited rows of one side to the controls of the other"""

    bl_idname = "mimetic.mirror_controls"
    bl_label = "Mirror Rows"
    bl_options = {"REGISTER", "UNDO"}

    from_side: EnumProperty(
        name="From",
        items=(("L", "Left", "The character's left"), ("R", "Right", "The character's right")),
        description="Side whose rows the other side gets",
    )

    def execute(self, context):
        character = scene_in.active(context)
        before = control_rows.rows_of(character)
        rows = native.controls().mirrored(before, self.from_side)
        _write_rows(character, rows)
        count = sum(row != old for row, old in zip(rows, before, strict=True))
        text = plural.one_or_many(count, rpt_("1 row changed"), rpt_("{count} rows changed"))
        return outcome.finished(self, context, text.format(count=count), num_rows=count)


class Preset(OnControls):
    """Mixin of operators on a preset's file."""

    filename_ext = ".json"
    filepath: StringProperty(
        name="Preset",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
        description="Table of controls, a .json file",
    )
    filter_glob: StringProperty(default="*.json", options={"HIDDEN"})

    def invoke(self, context, event):
        if not self.filepath:
            self.filepath = f"{bpy.path.clean_name(scene_in.active(context).name)}.controls.json"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}


class MIMETIC_OT_save_controls(Preset, Operator):
    """Save the table of controls as a preset, for other characters with the same controls"""

    bl_idname = "mimetic.save_controls"
    bl_label = "Save Controls"

    # The file browser asks before another preset is written over
    check_existing: BoolProperty(default=True, options={"HIDDEN"})

    def execute(self, context):
        rows = control_rows.rows_of(scene_in.active(context))
        try:
            path = Path(named_file(self.filepath, ".json"))
            native.controls().save_preset(rows, path)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        text = plural.one_or_many(len(rows), rpt_("{file}: 1 row"), rpt_("{file}: {count} rows"))
        message = text.format(file=path.name, count=len(rows))
        return outcome.finished(self, context, message, file=str(path))


class MIMETIC_OT_load_controls(Preset, Operator):
    """Load a preset: its rows count as edited by hand; controls that it lacks stay as they are"""

    bl_idname = "mimetic.load_controls"
    bl_label = "Load Controls"
    bl_options = {"REGISTER", "UNDO"}
    obstacle = staticmethod(targets.no_controls)

    def execute(self, context):
        character = scene_in.active(context)
        package = native.controls()
        before, ranges = control_rows.rows_of(character), ranges_of(character)
        try:
            preset = package.load_preset(bpy.path.abspath(self.filepath))
            first = package.refitted(before, ranges)
            rows, strangers = own_controls.with_preset(character, first, preset)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        _write_rows(character, [*rows, *package.waiting(before, ranges)])
        count = len(preset) - len(strangers)
        text = plural.one_or_many(
            count, rpt_("1 row from {file}"), rpt_("{count} rows from {file}")
        )
        message = text.format(count=count, file=Path(self.filepath).name)
        if strangers:
            message += rpt_("; {character} has no {names}").format(
                character=character.name, names=", ".join(strangers)
            )
        return outcome.finished(self, context, message, left_out=strangers)


CLASSES = (
    MIMETIC_OT_fit_controls,
    MIMETIC_OT_bake_controls,
    MIMETIC_OT_preview_controls,
    MIMETIC_OT_leave_preview,
    MIMETIC_OT_mirror_controls,
    MIMETIC_OT_save_controls,
    MIMETIC_OT_load_controls,
)
