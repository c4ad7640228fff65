# SPDX-License-Identifier: GPL-3.0-or-later
from bpy.app.translations import pgettext_iface as iface_
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.types import Operator

from .. import clips, editors, native, outcome, pins, scene_in, scene_out
from ..greyed import Greyed
from ..jobs import Job
from ..scene_out import landmarks


class Pinning(Greyed):
    """Mixin of operators that change pins: `change(context, clip)` returns the message."""

    bl_options = {"REGISTER", "UNDO"}
    needs_selection = True

    @classmethod
    def obstacle(cls, context):
        return scene_in.no_landmarks(context, cls.needs_selection)

    def execute(self, context):
        try:
            message = self.change(context, scene_in.clip_of(context))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        editors.redraw("CLIP_EDITOR")
        return outcome.finished(self, context, message)


class MIMETIC_OT_pin(Pinning, Operator):
    """Pin the selected landmarks where they are in the frame on show; dragging one pins it too"""

    bl_idname = "mimetic.pin"
    bl_label = "Pin"

    def change(self, context, clip):
        names = landmarks.selected(clip)
        pins.pin(clip, names, scene_in.shown_frame(context))
        return rpt_("Pinned {names}").format(names=", ".join(names))


class MIMETIC_OT_unpin(Pinning, Operator):
    """Release the selected landmarks: they return to where the fit has them"""

    bl_idname = "mimetic.unpin"
    bl_label = "Unpin"

    def change(self, context, clip):
        names = landmarks.selected(clip)
        pins.unpin(clip, names)
        return rpt_("Unpinned {names}").format(names=", ".join(names))


class MIMETIC_OT_follow_pins(Pinning, Operator):
    """Pin the landmarks that were moved, and fit the face to them; happens by itself in a window"""

    bl_idname = "mimetic.follow_pins"
    bl_label = "Fit to Pins"
    needs_selection = False

    def change(self, context, clip):
        names = pins.follow(clip)
        if not names:
            return rpt_("No landmark was moved")
        return rpt_("The face follows {names}").format(names=", ".join(names))


class MIMETIC_OT_show_landmarks(Job, Operator):
    """Find the face in the frame on show too, so that landmarks can be pinned there"""

    bl_idname = "mimetic.show_landmarks"
    bl_label = "Landmarks Here"
    bl_options = {"UNDO"}
    needs_object_mode = False

    @classmethod
    def obstacle(cls, context):
        reason = scene_in.no_footage(context)
        reason = reason or scene_in.no_landmarks(context, needs_selection=False, needs_frame=False)
        return reason

    def read(self, context):
        fit = scene_out.face_fit.of_clip(scene_in.clip_of(context))
        return scene_in.footage(context), fit, scene_in.shown_frame(context)

    def work(self, inputs, progress):
        footage, fit, frame = inputs
        progress(0.0, iface_("finding the face in frame {frame}").format(frame=frame))
        image = native.footage().Footage(footage.path).read(frame)
        return footage.clip_name, native.further_frame().with_frame(fit, image, frame), frame

    def write(self, context, result):
        clip_name, fit, frame = result
        scene_out.face_fit.store(clips.named(clip_name), fit)
        self.facts = {"clip": clip_name, "frames": [view.frame for view in fit.views]}
        return rpt_("The face is fitted to {count} frames now, frame {frame} among them").format(
            count=len(fit.views), frame=frame
        )


CLASSES = (
    MIMETIC_OT_pin,
    MIMETIC_OT_unpin,
    MIMETIC_OT_follow_pins,
    MIMETIC_OT_show_landmarks,
)
