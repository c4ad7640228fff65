# SPDX-License-Identifier: GPL-3.0-or-later
"""The person found in the footage: kept in the .blend as JSON, shown as tracks in the clip."""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy

from .. import native

TRACKING_OBJECT = "Face"  # apart from the user's own tracks


def store(scene: bpy.types.Scene, clip: bpy.types.MovieClip, fit) -> None:
    """Keeps a mimetic.fit.FaceFit with the scene, and marks its landmarks in the clip."""
    name = f"{Path(clip.name).stem} face.json"
    text = bpy.data.texts.get(name) or bpy.data.texts.new(name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "face.json")
        fit.save(path)
        text.from_string(path.read_text(encoding="utf-8"))
    scene.mimetic.face_fit = text
    _mark(clip, fit)


def stored(scene: bpy.types.Scene):
    """The scene's FaceFit, or None; raises InvalidInput if the text was edited into nonsense."""
    text = scene.mimetic.face_fit
    if text is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, text.name)
        path.write_text(text.as_string(), encoding="utf-8")
        return native.part("fit").FaceFit.load(path)


def _mark(clip: bpy.types.MovieClip, fit) -> None:
    """Marks the measured landmarks in the clip, instead of those of an earlier fit."""
    objects = clip.tracking.objects
    if TRACKING_OBJECT in objects:
        objects.remove(objects[TRACKING_OBJECT])
    marked = objects.new(TRACKING_OBJECT)
    places = native.part("projection").picture_coordinates(
        list(fit.features.values()), fit.image_size
    )
    frame = fit.frame - clip.frame_offset
    for name, place in zip(fit.features, places, strict=True):
        track = marked.tracks.new(name=name, frame=frame)
        track.markers.find_frame(frame).co = place
        track.lock = True
    objects.active = marked
