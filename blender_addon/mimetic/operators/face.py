# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import BoolProperty, FloatVectorProperty, IntProperty
from bpy.types import Operator

from .. import (
    carrying,
    clip_lens,
    clips,
    native,
    outcome,
    playback,
    scene_in,
    scene_out,
    workspace,
)
from ..greyed import Greyed
from ..jobs import Job
from . import arguments

LARGEST = (-1.0, -1.0)  # no place: of several faces the largest is taken


class MIMETIC_OT_find_face(Job, Operator):
    """Find the face in the footage, and fit head shape, pose and camera to it"""

    bl_idname = "mimetic.find_face"
    bl_label = "Find Face"
    bl_options = {"UNDO"}

    frame: IntProperty(
        name="Frame",
        min=0,
        description="Footage frame in which the face is at rest; 0: one is chosen",
    )
    use_shown_frame: BoolProperty(
        name="Rest = Shown Frame",
        description="The face is at rest in the frame that the clip editor shows",
    )
    near: FloatVectorProperty(
        name="Near",
        size=2,
        default=LARGEST,
        options={"SKIP_SAVE"},
        description="Pixel of the footage from the middle of the top left one; of several faces "
        "the nearest is taken. Outside the picture: the largest",
    )

    lens: arguments.like(clip_lens.HasLens, "lens")

    obstacle = staticmethod(scene_in.no_footage)
    needs_object_mode = False

    @classmethod
    def subject(cls, context):
        return clips.name_of(scene_in.clip_of(context))

    def invoke(self, context, event):
        is_anew = not carrying.is_handed_to(type(self))
        result = super().invoke(context, event)
        if is_anew and "RUNNING_MODAL" in result:
            workspace.show_footage(context)
        return result

    def read(self, context):
        frame = scene_in.shown_frame(context) if self.use_shown_frame else self.frame
        near = None if tuple(self.near) == LARGEST else tuple(self.near)
        clip = scene_in.clip_of(context)
        if arguments.is_given(self, "lens"):
            clip.mimetic.lens = self.lens
        return scene_in.footage(context), frame or None, near, clip_lens.known(clip)

    def work(self, inputs, progress):
        footage, frame, near, lens = inputs
        find = native.clip_capture().find_face
        fit = find(footage.path, frame, progress=progress, near=near, lens=lens)
        return footage.clip_name, fit, native.footage().Footage(footage.path).pixel_aspect

    def write(self, context, result):
        clip_name, fit, pixel_aspect = result
        clip = clips.named(clip_name)
        scene_out.clip.show_pixels(clip, pixel_aspect)  # Blender's own drop did not
        scene_out.face_fit.store(clip, fit)
        warnings = [*fit.warnings, *filter(None, [clip_lens.unread(clip)])]
        facts = {"clip": clip_name, "frame": fit.frame, "rest": fit.rest_text()}
        self.facts = facts | {"warnings": warnings}
        # What was found is on show at once; frame_set() would leave the clip editors behind
        if clip == scene_in.clip_of(context) and not playback.has_the_playhead():
            context.scene.frame_current = scene_in.scene_frame(clip, fit.frame)
        message = rpt_(
            "Face found in frame {frame}; drag its landmarks in the clip editor to pin them"
        ).format(frame=fit.frame)
        return "; ".join([message, *warnings])


class MIMETIC_OT_pick_face(Greyed, Operator):
    """Click on the face to find, where the footage shows several"""

    bl_idname = "mimetic.pick_face"
    bl_label = "Pick Face"

    @classmethod
    def obstacle(cls, context):
        reason = scene_in.no_footage(context) or scene_in.no_picture(context)
        return reason

    def invoke(self, context, event):
        try:  # as the file has it
            source = scene_in.footage(context).path
            self._size = native.footage().Footage(source).stored_size
            self._clip_name = clips.name_of(scene_in.clip_of(context))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set(iface_("Click on the face   |   Esc cancels"))
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type in {"ESC", "RIGHTMOUSE"}:
            self.cancel(context)
            return {"CANCELLED"}
        if event.type != "LEFTMOUSE":  # the picture may still be moved and enlarged
            return {"PASS_THROUGH"}
        if event.value != "PRESS":
            return {"RUNNING_MODAL"}
        self.cancel(context)
        place, clip = (event.mouse_x, event.mouse_y), bpy.data.movieclips.get(self._clip_name)
        area = scene_in.footage_area(context, *place, clip) if clip else None
        near = scene_in.footage_pixel(area, *place, self._size) if area else None
        if near is None:
            self.report({"WARNING"}, "That was beside the footage; nothing was changed")
            return {"CANCELLED"}
        region = next(region for region in area.regions if region.type == "WINDOW")
        # Its own editor may be gone, and the clip of another one would be looked at
        with context.temp_override(area=area, region=region):
            try:
                bpy.ops.mimetic.find_face("INVOKE_DEFAULT", near=near)
            except RuntimeError as error:  # it was pressed meanwhile, or the file is gone
                self.report({"WARNING"}, outcome.told_by(error))
                return {"CANCELLED"}
        return {"FINISHED"}

    def cancel(self, context):
        if context.window is not None:
            context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)


CLASSES = (MIMETIC_OT_find_face, MIMETIC_OT_pick_face)
