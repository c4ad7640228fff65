# SPDX-License-Identifier: GPL-3.0-or-later
"""Which of a clip's tracks are ours: the user's own may have any name, ours too."""

from __future__ import annotations

import bpy

LANDMARKS = "Face"  # the tracking object as it is called where no other is
# The tracks that hold the head still: its centre, and a point above it
HELD_BY = ("Head Centre", "Head Above")


def landmark_object(clip: bpy.types.MovieClip) -> bpy.types.MovieTrackingObject | None:
    """The tracking object of the landmarks, or None."""
    name = clip.mimetic.landmark_object
    if not name and clip.mimetic.landmarks_of:  # of a file of an earlier version
        name = LANDMARKS
    return clip.tracking.objects.get(name) if name else None


def new_landmark_object(clip: bpy.types.MovieClip) -> bpy.types.MovieTrackingObject:
    """A tracking object for landmarks, instead of the one before."""
    objects = clip.tracking.objects
    if (earlier := landmark_object(clip)) is not None:
        objects.remove(earlier)
    made = objects.new(LANDMARKS)
    clip.mimetic.landmark_object = made.name
    return made


def held_by(clip: bpy.types.MovieClip) -> list[str]:
    """Names of the tracks that hold the head still; none where it is not held."""
    names = clip.mimetic.held_by.split("\n")
    if not clip.mimetic.held_by:  # of a file of an earlier version
        stabilised = {track.name for track in clip.tracking.stabilization.tracks}
        names = list(HELD_BY) if HELD_BY[0] in stabilised else []
    tracks = clip.tracking.objects[0].tracks
    return [name for name in names if name in tracks]
