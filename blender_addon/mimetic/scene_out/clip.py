# SPDX-License-Identifier: GPL-3.0-or-later
"""The footage as a movie clip."""

from __future__ import annotations

import os

import bpy


def load(scene: bpy.types.Scene, path: str) -> bpy.types.MovieClip:
    """The movie clip of a file, loaded once, as the scene's footage."""
    path = os.path.abspath(path)
    clip = next(
        (
            known
            for known in bpy.data.movieclips
            if os.path.abspath(bpy.path.abspath(known.filepath, library=known.library)) == path
        ),
        None,
    )
    clip = clip or bpy.data.movieclips.load(path)
    scene.mimetic.clip = clip
    scene.active_clip = clip
    return clip


def show_pixels(shown: bpy.types.MovieClip | bpy.types.Image, aspect: float) -> None:
    """Shows pixels as wide for their height as the file says, which Blender does not read.

    An aspect that the user has set stays.
    """
    if tuple(shown.display_aspect) == (1.0, 1.0):
        shown.display_aspect = (aspect, 1.0)
