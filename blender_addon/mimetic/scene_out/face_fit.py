# SPDX-License-Identifier: GPL-3.0-or-later
"""The person found in the footage: kept in the .blend as JSON, shown as tracks in the clip.

The JSON is a property of the scene, and not a text, which undo would not take back with the tracks.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy

from .. import native
from . import landmarks

_parsed: tuple[str, object] | None = None  # the JSON that was read last, and its fit


def store(scene: bpy.types.Scene, clip: bpy.types.MovieClip, fit) -> None:
    """Keeps a mimetic.fit.FaceFit with the scene, and shows its landmarks in the clip."""
    keep(scene, fit)
    landmarks.show(clip, fit)


def update(scene: bpy.types.Scene, clip: bpy.types.MovieClip, fit) -> None:
    """As `store`, for a fit of the same frames: the tracks stay, only their markers move."""
    keep(scene, fit)
    landmarks.place(clip, fit)


def keep(scene: bpy.types.Scene, fit) -> None:
    """Keeps a fit with the scene whose landmarks are where they were."""
    global _parsed
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "face.json")
        fit.save(path)
        scene.mimetic.face_fit = path.read_text(encoding="utf-8")
    _parsed = None  # what is worked with is what the file holds, rounded, as it is after an undo


def is_calibrated(scene: bpy.types.Scene) -> bool:
    """Whether the fit knows this person's skin and muscles."""
    try:
        fit = stored(scene)
    except native.known_errors():
        return False
    return bool(fit and fit.calibration.frames)


def stored(scene: bpy.types.Scene):
    """The scene's FaceFit, or None; raises InvalidInput if it was edited into nonsense."""
    global _parsed
    content = scene.mimetic.face_fit
    if not content:
        return None
    if _parsed is None or _parsed[0] != content:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "face.json")
            path.write_text(content, encoding="utf-8")
            _parsed = (content, native.part("fit").FaceFit.load(path))
    return _parsed[1]
