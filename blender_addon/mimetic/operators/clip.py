# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.props import StringProperty
from bpy.types import Operator

from .. import clips, native, outcome, scene_out, takes
from ..greyed import Greyed
from .opened import Opened


class MIMETIC_OT_load_clip(Greyed, Operator, Opened):
    """Load footage of a face, and show it in the clip editor"""

    bl_idname = "mimetic.load_clip"
    bl_label = "Load Clip"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*.mp4;*.mov;*.avi;*.mkv;*.webm;*.m4v", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context):
        return native.problem()  # also while a job is at work on another clip

    def execute(self, context):
        path = bpy.path.abspath(self.filepath)
        try:
            footage = native.footage().Footage(path)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        clip = scene_out.clip.load(context.scene, path)
        scene_out.clip.show_pixels(clip, footage.pixel_aspect)
        scene_out.clip.show(context, clip)
        takes.adopt(context.scene, clip)
        width, height = footage.size
        messages = [f"{clip.name}: {width} x {height}, {float(footage.fps):.6g} frames/s"]
        warnings = [*footage.warnings, *filter(None, [clips.change_of(clip)])]
        level = "WARNING" if warnings else "INFO"
        facts = {"clip": clip.name, "size": [width, height], "fps": float(footage.fps)}
        facts["num_frames"] = footage.num_frames
        return outcome.finished(self, context, "; ".join(messages + warnings), level, **facts)
