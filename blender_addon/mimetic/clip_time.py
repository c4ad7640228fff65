# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's time beside the clip's. The clip editor shows one clip frame a scene frame whatever
the rates, and what is baked keeps to the seconds: at another rate the two differ."""

from __future__ import annotations

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import native


def range_of(clip: bpy.types.MovieClip) -> tuple[int, int]:
    """First and last scene frame of a range that shows the clip once."""
    num_frames = max(clip.frame_duration - clip.frame_offset, 1)
    last = clip.frame_start + num_frames - 1
    # A scene's range has no negative frames
    return max(clip.frame_start, 0), max(last, 0)


def scene_rate(scene: bpy.types.Scene):
    """The scene's frames a second, exactly."""
    return native.timing().exact_rate(scene.render.fps / scene.render.fps_base)


def is_known(clip: bpy.types.MovieClip | None) -> bool:
    """Whether the clip's rate and length are known: its file is there."""
    return clip is not None and clip.frame_duration > 0 and (_is_pictures(clip) or clip.fps > 0)


def rate_of(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> float:
    """Frames a second; numbered pictures have the scene's."""
    return float(scene_rate(scene)) if _is_pictures(clip) else clip.fps


def _is_pictures(clip: bpy.types.MovieClip) -> bool:
    return clip.source == "SEQUENCE"


def has_rate(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> bool:
    return native.timing().is_same_rate(rate_of(scene, clip), float(scene_rate(scene)))


def has_range(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> bool:
    return (scene.frame_start, scene.frame_end) == range_of(clip)


def remark(scene: bpy.types.Scene, clip: bpy.types.MovieClip | None) -> str:
    """What to say while the rates differ, or the empty string."""
    if not is_known(clip) or has_rate(scene, clip):
        return ""
    rate = scene.render.fps / scene.render.fps_base
    return iface_(
        "The clip has {fps:.6g} frames/s, the scene {rate:.6g}: the clip "
        "editor shows other frames than the face, which keeps to the seconds"
    ).format(fps=clip.fps, rate=rate)


def apply(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> None:
    if not _is_pictures(clip):
        rate = native.timing().scene_rate(clip.fps)
        scene.render.fps, scene.render.fps_base = rate.fps, rate.fps_base
    # Each end pushes the other along where it would pass it
    first, last = range_of(clip)
    scene.frame_start, scene.frame_end = first, last
    scene.frame_start = first
