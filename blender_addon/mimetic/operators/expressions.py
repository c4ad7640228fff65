# SPDX-License-Identifier: GPL-3.0-or-later
"""Expressions kept as assets, put on a face, mirrored and saved; `sequence` has the NLA's."""

from pathlib import Path

import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy.types import Operator

from .. import editors, native, outcome, plural, scene_in, scene_out
from ..greyed import Greyed
from ..jobs import Job
from .chosen_expression import OfExpression, OnFace, chosen

PIXELS_OF_DRAG = 300  # that the mouse moves from rest to the whole expression


def show(scene, action: bpy.types.Action) -> None:
    """Makes an expression the one that buttons mean."""
    scene.mimetic.expression = action


class MIMETIC_OT_keep_expression(Greyed, Operator):
    """Keep what the face does as an asset: as it is now, or its curves over some frames"""

    bl_idname = "mimetic.keep_expression"
    bl_label = "Keep Expression"
    bl_options = {"REGISTER", "UNDO"}

    name: StringProperty(
        name="Name", default="Expression", description="Of the asset, and of its action"
    )
    kind: EnumProperty(
        name="Keep",
        items=(
            ("STILL", "Still", "What the sliders are at now"),
            ("MOTION", "Motion", "What the curves do over some frames, from rest to rest"),
        ),
        description="What of the face is kept",
    )
    frame_first: IntProperty(name="First", description="Scene frame at which it begins")
    frame_last: IntProperty(name="Last", description="Scene frame at which it ends")

    obstacle = staticmethod(scene_in.no_sliders)

    def invoke(self, context, event):
        scene = context.scene
        if self.frame_first == self.frame_last:
            preview = scene.use_preview_range
            self.frame_first = scene.frame_preview_start if preview else scene.frame_start
            self.frame_last = scene.frame_preview_end if preview else scene.frame_end
        return context.window_manager.invoke_props_dialog(self)

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "name")
        layout.prop(self, "kind", expand=True)
        column = layout.column(align=True)
        column.active = self.kind == "MOTION"
        column.prop(self, "frame_first")
        column.prop(self, "frame_last")

    def execute(self, context):
        face, rate = scene_in.face_of(context), scene_in.timing(context.scene, None).scene_rate
        expressions = scene_out.expressions
        try:
            if self.kind == "STILL":
                document = expressions.keep_still(face, rate)
            else:
                first, last = self.frame_first, self.frame_last
                document = expressions.keep_motion(context.scene, face, first, last, rate)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        action = expressions.new_asset(
            self.name, document, rate, scene_out.expressions.picture_of(document)
        )
        show(context.scene, action)
        message = f"{action.name}: {expressions.description(document)}"
        return outcome.finished(self, context, message, action=action.name)


class MIMETIC_OT_apply_expression(OnFace, Operator):
    """Put the face into an expression; drag to blend from what it is, M mirrors, Esc leaves it"""

    bl_idname = "mimetic.apply_expression"
    bl_label = "Blend Expression"
    bl_options = {"REGISTER", "UNDO", "BLOCKING", "GRAB_CURSOR"}

    share: FloatProperty(
        name="Blend",
        default=1.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        description="From what the face is, 0, to the expression, 1",
    )
    is_mirrored: BoolProperty(
        name="Mirrored", options={"SKIP_SAVE"}, description="The other side's"
    )
    use_key: BoolProperty(
        name="Key",
        options={"SKIP_SAVE"},
        description="Key its sliders in this frame, as auto keying does",
    )

    def execute(self, context):
        if not self._begin(context):
            return {"CANCELLED"}
        self._blend()
        return self._finish(context)

    def invoke(self, context, event):
        if context.window is None:
            return self.execute(context)
        if not self._begin(context):
            return {"CANCELLED"}
        self.share, self._mouse = 0.0, event.mouse_x
        context.window_manager.modal_handler_add(self)
        self._show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "MOUSEMOVE":
            self.share = min(max((event.mouse_x - self._mouse) / PIXELS_OF_DRAG, 0.0), 1.0)
        elif event.type == "M" and event.value == "PRESS":
            self._restore()
            self.is_mirrored = not self.is_mirrored
            self._read(context)
        elif event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            self.cancel(context)
            return {"CANCELLED"}
        elif event.type in {"LEFTMOUSE", "RET"} and event.value == "PRESS":
            context.workspace.status_text_set(None)
            return self._finish(context)
        else:
            return {"RUNNING_MODAL"}
        self._blend()
        self._show(context)
        return {"RUNNING_MODAL"}

    def cancel(self, context):
        """Blender ends it: its window was closed, or a file is loaded."""
        self._restore()
        context.workspace.status_text_set(None)

    def _begin(self, context) -> bool:
        try:
            self._chosen = chosen(context, self.action)
        except native.known_errors() as error:
            outcome.cancelled(self, context, str(error))
            return False
        self.action = self._chosen.name
        self._face_name = scene_in.face_of(context).name
        return self._read(context)

    def _read(self, context) -> bool:
        """What the sliders are, and what the expression makes of them."""
        expressions = scene_out.expressions
        face = bpy.data.objects[self._face_name]
        values = expressions.peak_values(bpy.data.actions[self.action], self.is_mirrored)
        self._target, self._missing, self._start = {}, [], {}
        try:
            self._target, self._missing = expressions.sliders_for(face, values, self.action)
        except native.known_errors() as error:
            outcome.cancelled(self, context, str(error))
            return False
        blocks = face.data.shape_keys.key_blocks
        self._start = {name: blocks[name].value for name in self._target}
        return True

    def _blend(self) -> None:
        values = scene_out.expressions.blended(self._start, self._target, self.share)
        scene_out.sliders.set_values(bpy.data.objects[self._face_name], values)

    def _restore(self) -> None:
        scene_out.sliders.set_values(bpy.data.objects[self._face_name], self._start)

    def _finish(self, context):
        face, scene = bpy.data.objects[self._face_name], context.scene
        has_keys = self.use_key or scene.tool_settings.use_keyframe_insert_auto
        if has_keys:
            scene_out.expressions.key_sliders(face, self._target, scene.frame_current)
        text = rpt_("{action} at {share:.0%} on {face}").format(
            action=self.action, share=self.share, face=face.name
        )
        text += rpt_(", keyed") if has_keys else rpt_("; auto keying is off")
        text += scene_out.expressions.missing_text(face, self._missing)
        facts = {"action": self.action, "object": face.name, "is_keyed": has_keys}
        return outcome.finished(self, context, text, **facts)

    def _show(self, context) -> None:
        note = iface_(", mirrored") if self.is_mirrored else ""
        context.workspace.status_text_set(
            iface_(
                "{action}{note}: {share:.0%}   |   drag blends, M mirrors, click "
                "keeps, Esc leaves the face as it was"
            ).format(action=self.action, note=note, share=self.share)
        )
        editors.redraw("VIEW_3D")


class MIMETIC_OT_mirror_expression(OfExpression, Operator):
    """Keep an expression of the other side as a new asset"""

    bl_idname = "mimetic.mirror_expression"
    bl_label = "Mirror Expression"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context):
        expressions = scene_out.expressions
        try:
            action = chosen(context, self.action)
            document = expressions.document_of(action).mirrored()
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        name, rate = f"{action.name} mirrored", float(action[expressions.RATE])
        picture = scene_out.expressions.picture_of(document)
        asset = expressions.new_asset(name, document, rate, picture)
        show(context.scene, asset)
        return outcome.finished(
            self, context, rpt_("{name} is kept").format(name=name), action=asset.name
        )


class MIMETIC_OT_load_expressions(Job, Operator):
    """Make an asset of every expression in a library's folder, which `mimetic library` writes"""

    bl_idname = "mimetic.load_expressions"
    bl_label = "Load Library"
    bl_options = {"REGISTER", "UNDO"}

    directory: StringProperty(
        name="Folder",
        subtype="DIR_PATH",
        description="Library to load: a folder that `mimetic library` made",
    )
    filter_folder: BoolProperty(default=True, options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context):
        return scene_in.no_start()

    def invoke(self, context, event):
        if self.directory or context.window is None:
            return super().invoke(context, event)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def read(self, context):
        return bpy.path.abspath(self.directory)

    def work(self, inputs, progress):
        library = native.library("folder").Library(Path(inputs))
        names, entries = library.names(), []
        for i, name in enumerate(names):
            if not progress(i / len(names), name):
                break
            document = library.load(name)
            entries.append((name, document, scene_out.expressions.picture_of(document)))
        return entries

    def write(self, context, result):
        rate = scene_in.timing(context.scene, None).scene_rate
        for name, document, picture in result:
            show(context.scene, scene_out.expressions.new_asset(name, document, rate, picture))
        return plural.one_or_many(
            len(result),
            rpt_("1 expression is an asset now: {names}"),
            rpt_("{count} expressions are assets now: {names}"),
        ).format(count=len(result), names=", ".join(name for name, *_ in result))


class MIMETIC_OT_save_expression(OfExpression, Operator):
    """Write an expression to a library's folder, for `mimetic library` and other files"""

    bl_idname = "mimetic.save_expression"
    bl_label = "Save to Library"

    directory: StringProperty(
        name="Folder", subtype="DIR_PATH", description="Library to write to, made if it is missing"
    )
    filter_folder: BoolProperty(default=True, options={"HIDDEN"})
    use_replace: BoolProperty(name="Replace", description="Even if the folder has one of its name")

    def invoke(self, context, event):
        if self.directory or context.window is None:
            return self.execute(context)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        try:
            action = chosen(context, self.action)
            document = scene_out.expressions.document_of(action)
            library = native.library("folder").Library(Path(bpy.path.abspath(self.directory)))
            library.check_new(action.name, self.use_replace)
            path = library.keep(action.name, document, scene_out.expressions.picture_of(document))
        except native.known_errors() as error:
            message = str(error).replace("--replace", rpt_("tick Replace"))
            return outcome.cancelled(self, context, message)
        return outcome.finished(
            self, context, rpt_("{path} is written").format(path=path), file=str(path)
        )


def draw_in_asset_menu(menu, context) -> None:
    """In the Asset Browser: what an expression there can be used for."""
    layout = menu.layout
    layout.separator()
    layout.operator(MIMETIC_OT_apply_expression.bl_idname, icon="USER")
    layout.operator("mimetic.sequence_expression", icon="NLA")
    layout.operator(MIMETIC_OT_mirror_expression.bl_idname, icon="MOD_MIRROR")


CLASSES = (
    MIMETIC_OT_keep_expression,
    MIMETIC_OT_apply_expression,
    MIMETIC_OT_mirror_expression,
    MIMETIC_OT_load_expressions,
    MIMETIC_OT_save_expression,
)
