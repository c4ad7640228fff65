# SPDX-License-Identifier: GPL-3.0-or-later
"""The one button that takes footage further, for whoever has never seen the panel."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import clips, corrections, heads, native, scene_in, shown_take, takes


@dataclass(frozen=True)
class Step:
    operator: str  # "" where nothing is left to do
    text: str  # of its button
    beside: str = ""  # what else is to be known


FIND_FILES = Step("mimetic.find_missing", "Next: Find Missing Files")
LOAD = Step("mimetic.load_clip", "Next: Load Clip", "Or drop a video here")
FIND = Step("mimetic.find_face", "Next: Find Face")
CAPTURE = Step("mimetic.capture", "Next: Capture")
REFINE = Step("mimetic.refine", "Next: Refine", "For what was corrected")
ATTACH = "mimetic.attach_muscles"
BAKE = Step("mimetic.bake", "Next: Bake")
DONE = Step("", "", "Baked. In a frame where the face is off: Pin Skin or Correct (Corrections)")


def of(context) -> Step:
    """The step that comes next for the clip on show, or for the take while there is no clip."""
    if moved := landmarks_moved(context):
        return Step(ATTACH, "Next: Attach Muscles", moved)
    clip = scene_in.clip_of(context)
    holder = takes.of_clip(context.scene, clip)
    if clip is None and holder is None:
        return LOAD
    if holder is None:
        return _to_take(clip)
    if not takes.find(holder):
        return FIND_FILES
    if clip is not None and not clips.is_missing(clip) and _waits_for_refine(context, clip):
        return REFINE
    return DONE if _is_baked(context.scene, clip, takes.name_of(holder)) else BAKE


def landmarks_moved(context) -> str:
    """Which landmarks of the active head its muscles do not know yet, or nothing."""
    head = heads.active_head(context)
    if not (names := heads.moved_landmarks(context.scene, head)):
        return ""
    return iface_("{head}: landmarks moved: {names}").format(head=head.name, names=", ".join(names))


def _to_take(clip: bpy.types.MovieClip) -> Step:
    if clips.is_missing(clip):
        return FIND_FILES
    return CAPTURE if scene_in.has_fit(clip) else FIND


def _waits_for_refine(context, clip: bpy.types.MovieClip) -> bool:
    """Whether something was corrected that the take does not honour, or no longer is."""
    if corrections.frames_of(clip):
        performance = shown_take.performance_or_none(context)
    else:  # not read for that alone: a long take needs a while
        performance = shown_take.last_read(context)
    try:
        entries = corrections.of_clip(clip)
    except native.known_errors():  # the button says so
        return False
    is_read = performance is not None
    return is_read and not native.correcting().is_refined_by(performance, entries)


def _is_baked(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None, file_name: str) -> bool:
    shown = native.shown_text().shown(file_name)
    mark = clips.fingerprint(clip) if clip else ""  # other clips may have a file of that name
    rows = (row for obj in scene.objects for row in obj.mimetic.takes)
    return any(row.performance == shown and (not mark or row.footage in ("", mark)) for row in rows)
