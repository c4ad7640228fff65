# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage as a movie clip."""

from __future__ import annotations

import contextlib
import os

import bpy

from .. import clips, native


def load(scene: bpy.types.Scene, path: str) -> bpy.types.MovieClip:
    """The movie clip of a file or of numbered pictures, loaded once, as the scene's footage.

    A file that was moved or renamed is the clip that it was: the same content, and all that was
    kept of it.
    """
    source = native.footage().opened(path)
    path = os.path.abspath(source)
    own = [c for c in bpy.data.movieclips if not c.library]
    clip = next((c for c in own if os.path.abspath(clips.path_of(c)) == path), None)
    if clip is None:
        clip = clips.with_content(native.clip_fingerprint().fingerprint(source))
        if clip is None:
            clip = bpy.data.movieclips.load(path)
            place(clip, path)
        elif clips.is_missing(clip):
            place(clip, path)
    elif clips.change_of(clip):
        place(clip, path)  # Blender still has the earlier file in memory
    clips.settle(clip)
    scene.mimetic.clip = clip
    scene.active_clip = clip
    return clip


def show_pixels(pixels: bpy.types.MovieClip | bpy.types.Image, aspect: float) -> None:
    """Shows pixels as wide for their height as the file says, which Blender does not read.

    An aspect that the user has set stays.
    """
    if tuple(pixels.display_aspect) == (1.0, 1.0):
        pixels.display_aspect = (aspect, 1.0)


def place(clip: bpy.types.MovieClip, path: str) -> None:
    """Says where the clip's file is, as Blender's preferences have it: relative to the .blend."""
    if bpy.data.filepath and bpy.context.preferences.filepaths.use_relative_paths:
        with contextlib.suppress(ValueError):  # on another of Windows' drives
            path = bpy.path.relpath(path)
    clip.filepath = path


def show(context, clip: bpy.types.MovieClip) -> None:
    """Makes the clip the scene's, on show in every clip editor."""
    context.scene.mimetic.clip = clip
    context.scene.active_clip = clip
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "CLIP_EDITOR":
                area.spaces.active.clip = clip
