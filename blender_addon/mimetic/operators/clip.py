# SPDX-License-Identifier: GPL-3.0-or-later
import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy.types import Operator

from .. import captured_takes, clip_time, clips, compat, native, outcome, scene_out, workspace
from ..greyed import Greyed
from .opened import Opened

MOVIES = "*.mp4;*.mov;*.avi;*.mkv;*.webm;*.m4v"
PICTURES = "*.png;*.jpg;*.jpeg;*.exr;*.tif;*.tiff;*.dpx;*.bmp;*.tga"


class MIMETIC_OT_load_clip(Greyed, Operator, Opened):
    """Load footage of a face, a movie or numbered pictures from the chosen one on, and show it in \
the clip editor, or in a workspace that has one"""

    bl_idname = "mimetic.load_clip"
    bl_label = "Load Clip"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default=f"{MOVIES};{PICTURES}", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context):
        return native.problem()  # also while a job is at work on another clip

    def execute(self, context):
        path = bpy.path.abspath(self.filepath)
        try:
            footage = native.footage().Footage(_at_scene_rate(path, context.scene))
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        clip = scene_out.clip.load(context.scene, path)
        scene_out.clip.show_pixels(clip, footage.pixel_aspect)
        scene_out.clip.show(context, clip)
        captured_takes.adopt(context.scene, clip)
        if self.is_by_hand:
            workspace.show_footage(context)
        width, height = footage.size
        messages = [
            rpt_("{clip}: {width} x {height}, {fps:.6g} frames/s").format(
                clip=clip.name, width=width, height=height, fps=float(footage.fps)
            )
        ]
        warnings = [*footage.warnings, *filter(None, [clips.change_of(clip), _unturned(footage)])]
        level = "WARNING" if warnings else "INFO"
        facts = {"clip": clip.name, "size": [width, height], "fps": float(footage.fps)}
        facts["num_frames"] = footage.num_frames
        return outcome.finished(self, context, "; ".join(messages + warnings), level, **facts)


def _unturned(footage) -> str:
    """A warning where this Blender shows pictures otherwise than the file means them, or ""."""
    if compat.CLIPS_ARE_TURNED or not footage.rotation:
        return ""
    return rpt_(
        "{path} says that it is turned by {rotation} degrees, which this "
        "Blender does not read: what is drawn over it will lie beside; turn it "
        "for good (ffmpeg -i {path} upright.mp4) and load that, or take "
        "Blender 4.5"
    ).format(path=footage.path.name, rotation=footage.rotation)


def _at_scene_rate(path: str, scene: bpy.types.Scene):
    """What a path names; pictures have no rate of their own, and play at the scene's."""
    media = native.footage()
    if not media.is_sequence(path):
        return path
    return media.ImageSequence(path, clip_time.scene_rate(scene))
