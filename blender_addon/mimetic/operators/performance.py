# SPDX-License-Identifier: GPL-3.0-or-later
from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy.types import Operator

from .. import captured_takes, clips, native, outcome, scene_in, scene_out
from ..greyed import Greyed
from .opened import Opened


class MIMETIC_OT_load_performance(Greyed, Operator, Opened):
    """Choose a captured performance to bake; its clip is shown, if that can be found"""

    bl_idname = "mimetic.load_performance"
    bl_label = "Load Performance"
    bl_options = {"REGISTER", "UNDO"}

    filename_ext = ".npz"
    filter_glob: StringProperty(default="*.npz", options={"HIDDEN"})

    @classmethod
    def obstacle(cls, context):
        return scene_in.no_start()

    def execute(self, context):
        path = bpy.path.abspath(self.filepath)
        try:
            performance = native.performances().Performance.load(path)
            clip = _clip_of(context, performance, path)
        except native.known_errors() as error:
            return outcome.cancelled(self, context, str(error))
        of_take = native.take_facts().facts_of(performance)
        first, last = of_take.first, of_take.last
        messages = [
            rpt_("Frames {first} to {last} at {fps:.6g} frames/s").format(
                first=first, last=last, fps=performance.fps
            )
        ]
        if clip is not None and clip != scene_in.clip_of(context):
            scene_out.clip.show(context, clip)
            messages.append(rpt_("it is of {clip}, which is shown now").format(clip=clip.name))
        elif clip is None and performance.footage:
            messages.append(
                rpt_("{footage}, which it is of, is not found: no footage").format(
                    footage=performance.footage[0]
                )
            )
        captured_takes.keep(context.scene, clip, path, of_take)
        messages += performance.notes or []
        level = "WARNING" if performance.notes else "INFO"
        facts = {"performance": path, "clip": clip.name if clip else ""}
        facts["footage_frames"] = [first, last]
        return outcome.finished(self, context, "; ".join(messages), level, **facts)


def _clip_of(context, performance, path: str) -> bpy.types.MovieClip | None:
    """The clip that a performance is of: the one on show, another, or one that lies near.

    None without any; raises InvalidInput if only another person's clip is on show.
    """
    current = scene_in.clip_of(context)
    if performance.footage is None:
        return current
    name, mark = performance.footage
    if current and clips.fingerprint(current) == mark:
        return current
    if clip := clips.with_content(mark):
        return clip
    files = native.clip_fingerprint()
    near = [Path(path).parent, *([Path(bpy.data.filepath).parent] if bpy.data.filepath else ())]
    near += [Path(clips.path_of(clip)).parent for clip in bpy.data.movieclips]
    for folder in dict.fromkeys(near):
        if file := files.find_content(mark, files.files_in(folder)):
            return scene_out.clip.load(context.scene, str(file))
    if current is None:
        return None
    raise native.invalid_input(
        rpt_(
            "{file} was captured from {footage}, not from {clip}: load {footage} "
            "first (Load Clip), or take the footage away to bake without one"
        ).format(file=Path(path).name, footage=name, clip=current.name)
    )
