# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty

from .. import captured_takes, clip_lens, clips, native, scene_in, scene_out, takes
from ..jobs import Job
from . import arguments


class Following(arguments.FrameRange, Job):
    """Mixin of operators that make a performance from the clip; stopping keeps what is done.

    Subclasses give `follow(option, footage_path, progress, frames, fit, lens)`, which runs without
    bpy and returns the performance, and may give `option(context)` and `learned(option)`.
    """

    bl_options = {"UNDO"}
    keeps_part = True
    needs_object_mode = False
    message = "{first} to {last}"

    filepath: StringProperty(
        name="Performance",
        subtype="FILE_PATH",
        description="File to write (.npz); empty: beside the .blend, a new one for each take",
    )

    lens: arguments.like(clip_lens.HasLens, "lens")

    obstacle = staticmethod(scene_in.no_footage)

    @classmethod
    def subject(cls, context):
        return clips.name_of(scene_in.clip_of(context))

    def option(self, context):
        return None

    @staticmethod
    def learned(option):
        """What following found out of the person: a FaceFit for the clip; None: nothing."""
        return None

    def read(self, context):
        footage = scene_in.footage(context)
        new = takes.new_take(footage.clip_name, self.filepath)
        clip = scene_in.clip_of(context)
        if arguments.is_given(self, "lens"):
            clip.mimetic.lens = self.lens
        what = {
            "frames": arguments.frame_range(self, context),
            "fit": scene_out.face_fit.of_clip(clip),
            "lens": clip_lens.known(clip),
        }
        return footage, what, new, self.option(context), scene_out.face_fit.content(clip)

    def work(self, inputs, progress):
        footage, what, new, option, fit_before = inputs
        performance = self.follow(option, footage.path, progress, **what)
        path, remarks = takes.save(performance, new)
        of_take = native.take_facts().facts_of(performance)
        message = rpt_(self.message).format(first=of_take.first, last=of_take.last)
        facts = {
            "clip": footage.clip_name,
            "performance": path,
            "footage_frames": [of_take.first, of_take.last],
            "quality": round(of_take.quality, 3),
            "num_held": of_take.num_held,
        }
        return facts, of_take, [message, *remarks], fit_before, self.learned(option)

    def write(self, context, result):
        self.facts, of_take, remarks, fit_before, learned_fit = result
        clip_name, path = self.facts["clip"], self.facts["performance"]
        clip = bpy.data.movieclips.get(clip_name)
        if learned_fit is not None and clip is not None:
            scene_out.face_fit.learn(clip, fit_before, learned_fit)
        gone = captured_takes.keep_for(context.scene, clip_name, path, of_take)
        return "; ".join([*remarks, *gone])
