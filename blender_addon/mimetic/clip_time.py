# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene's time beside the clip's. The clip editor shows one clip frame a scene frame whatever
the rates, and what is baked keeps to the seconds: at another rate the two differ."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
from bpy.app.translations import pgettext_iface as iface_

from . import native


@dataclass(frozen=True)
class SceneTime:
    fps: int
    fps_base: float
    first: int  # scene frames
    last: int


def of_clip(clip: bpy.types.MovieClip) -> SceneTime:
    """The rate and range at which a scene shows the clip frame by frame, once."""
    rate = native.timing().scene_rate(clip.fps)
    num_frames = max(clip.frame_duration - clip.frame_offset, 1)
    last = clip.frame_start + num_frames - 1
    # A scene's range has no negative frames
    return SceneTime(rate.fps, rate.fps_base, max(clip.frame_start, 0), max(last, 0))


def scene_rate(scene: bpy.types.Scene):
    """The scene's frames a second, exactly."""
    return native.timing().exact_rate(scene.render.fps / scene.render.fps_base)


def is_known(clip: bpy.types.MovieClip | None) -> bool:
    """Whether the clip's own rate and length are known: its file is there."""
    return clip is not None and clip.fps > 0 and clip.frame_duration > 0


def has_rate(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> bool:
    return native.timing().is_same_rate(clip.fps, float(scene_rate(scene)))


def has_range(scene: bpy.types.Scene, clip: bpy.types.MovieClip) -> bool:
    time = of_clip(clip)
    return (scene.frame_start, scene.frame_end) == (time.first, time.last)


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
    time = of_clip(clip)
    scene.render.fps, scene.render.fps_base = time.fps, time.fps_base
    # Each end pushes the other along where it would pass it
    scene.frame_start, scene.frame_end = time.first, time.last
    scene.frame_start = time.first
