# SPDX-License-Identifier: GPL-3.0-or-later
from pathlib import Path

import bpy
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from bpy.types import Operator

from .. import clips, native, outcome, scene_in, scene_out, takes
from ..greyed import Greyed

DEPTH = 16  # folders in folders, as Blender's own search


class MIMETIC_OT_find_missing(Greyed, Operator):
    """Look in a folder, and in all folders in it, for performances and footage that are missing: \
performances by name, footage by its content, whatever it is called now"""

    bl_idname = "mimetic.find_missing"
    bl_label = "Find Missing Files"
    bl_options = {"UNDO"}

    directory: StringProperty(
        name="Folder", subtype="DIR_PATH", description="Where to look, and in all folders in it"
    )

    @classmethod
    def obstacle(cls, context):
        reason = scene_in.no_start()
        if not reason and not _missing_clips() and not takes.missing():
            reason = "No performance and no footage is missing"
        return reason

    def invoke(self, context, event):
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context):
        folder = Path(bpy.path.abspath(self.directory))
        if not folder.is_dir():
            message = rpt_("{folder}: there is no such folder; choose another").format(
                folder=folder
            )
            return outcome.cancelled(self, context, message)
        lines = list(dict.fromkeys([*_find_clips(folder), *_find_takes(folder)]))
        absent = [clip.name for clip in _missing_clips()] + list(
            map(takes.name_of, takes.missing())
        )
        absent = list(dict.fromkeys(absent))
        left = rpt_("{names}: not in {folder} nor in a folder in it").format(
            names=", ".join(absent), folder=folder
        )
        if not lines:
            return outcome.cancelled(self, context, left, "WARNING")
        if absent:
            self.report({"WARNING"}, left)
        message = rpt_("Found {files}").format(files=", ".join(lines))
        return outcome.finished(self, context, message, files=lines, missing=absent)


def _missing_clips() -> list[bpy.types.MovieClip]:
    """Clips of ours: Blender looks for all others."""
    ours = [c for c in bpy.data.movieclips if c.mimetic.fingerprint]
    return [clip for clip in ours if not clip.library and clips.is_missing(clip)]


def _find_clips(folder: Path) -> list[str]:
    files = native.clip_fingerprint()
    lines = []
    for clip in _missing_clips():
        path = files.find_content(clip.mimetic.fingerprint, files.files_in(folder, DEPTH))
        if path:
            scene_out.clip.place(clip, str(path))
            lines.append(path.name)
    return lines


def _find_takes(folder: Path) -> list[str]:
    """By name; of several the first that is of the clip's content."""
    names = {takes.name_of(holder) for holder in takes.missing()}
    candidates: dict[str, list[Path]] = {}
    if names:
        for path in native.clip_fingerprint().files_in(folder, DEPTH):
            if path.name in names:
                candidates.setdefault(path.name, []).append(path)
    lines = []
    for holder in takes.missing():
        for path in candidates.get(takes.name_of(holder), ()):
            if takes.place(holder, str(path)):
                lines.append(path.name)
                break
    return lines
