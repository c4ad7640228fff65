# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality of captured frames in Timeline, Dope Sheet and Graph Editor, where the keys of a bake
are or will be: in the row of frame numbers, below them. Blender's own timeline shows no other row.
"""

from __future__ import annotations

import bpy
import gpu

from .. import clip_time, native, scene_in
from . import quality, seen

NUMBERS = 23  # height of the row of frame numbers, pixels at a UI scale of 1
HEIGHT = 3  # of the boxes, and again of those above them: as much is free below the numbers


def draw_strip() -> None:
    context = bpy.context
    if native.problem() or not context.scene.mimetic.show_quality or not _shows_time(context):
        return
    shown = seen.of_work(context) or seen.of_take(context)
    if shown is None:
        return
    try:
        first, step = _scene_frames(context, shown)
    except native.known_errors():  # they fall off the end of the timeline
        return
    region = context.region
    left, right = (region.view2d.region_to_view(x, 0)[0] for x in (0, region.width))
    if right <= left:
        return
    per_scene_frame = region.width / (right - left)
    scale = context.preferences.system.ui_scale
    bottom = region.height - NUMBERS * scale
    # A frame's key is drawn in the middle of its box
    begin = (first - 0.5 * step - left) * per_scene_frame
    gpu.state.blend_set("ALPHA")
    try:
        quality.draw(context, shown, begin, step * per_scene_frame, bottom, HEIGHT * scale)
    finally:
        gpu.state.blend_set("NONE")


def _shows_time(context) -> bool:
    """Whether the editor's width is the scene's time, and its overlays are on."""
    space = context.space_data
    if space.type == "GRAPH_EDITOR" and space.mode == "DRIVERS":
        return False
    overlays = getattr(space, "overlays", None)  # not of every version's editors
    return getattr(overlays, "show_overlays", True)


def _scene_frames(context, shown: seen.Seen) -> tuple[float, float]:
    """The scene frame of footage frame 1, and from one to the next, as a bake has them."""
    scene, clip = context.scene, scene_in.clip_of(context)
    if shown.performance is not None:
        rate = shown.performance.fps
    else:
        known = clip_time.is_known(clip)
        rate = clip_time.rate_of(scene, clip) if known else float(clip_time.scene_rate(scene))
    first, second = scene_in.scene_frames_of([1, 2], rate, scene_in.timing(scene, clip))
    return float(first), float(second - first)
