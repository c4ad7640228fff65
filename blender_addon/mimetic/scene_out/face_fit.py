# SPDX-License-Identifier: GPL-3.0-or-later
"""The person found in a clip: kept with it in the .blend as JSON, shown as its tracks.

The JSON is a property of the clip, and not a text, which undo would not take back with the tracks.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import bpy
from bpy.app.translations import pgettext_iface as iface_

from .. import clip_lens, clips, native
from . import landmarks

MOST_PARSED = 8
_fits: dict[str, object] = {}  # JSON that was read, and its fit


def store(clip: bpy.types.MovieClip, fit) -> None:
    """Keeps a mimetic.fit.FaceFit with the clip, and shows its landmarks there."""
    keep(clip, fit)
    landmarks.show(clip, fit)
    _landmarks_are_here(clip)


def update(clip: bpy.types.MovieClip, fit) -> None:
    """As `store`, for a fit of the same frames: the tracks stay, only their markers move."""
    keep(clip, fit)
    landmarks.place(clip, fit)
    _landmarks_are_here(clip)


def _landmarks_are_here(clip) -> None:
    mark = clips.find(clip).name
    for other in bpy.data.movieclips:  # of the same content: theirs are of the fit before
        if other != clip and other.mimetic.landmarks_of == mark:
            other.mimetic.landmarks_of = ""
    clip.mimetic.landmarks_of = mark


def keep(clip: bpy.types.MovieClip, fit) -> None:
    """Keeps a fit with the clip whose landmarks are where they were."""
    record = clips.ensure(clip)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "face.json")
        fit.save(path)
        # What is worked with is what the file holds, rounded, as it is after an undo
        record.face_fit = path.read_text(encoding="utf-8")


def learn(clip: bpy.types.MovieClip, before: str, fit) -> None:
    """Keeps what a capture found out of the person, unless another fit was kept since it began.

    before: the clip's `content` then; fit: that one, or the one that the capture found, with how
    far this person's muscles go: takes of one person share their scale.
    """
    if content(clip) != before:
        return
    if not before:
        store(clip, fit)
    elif fit.calibration != of_clip(clip).calibration:
        keep(clip, fit)


def content(clip: bpy.types.MovieClip | None) -> str:
    """The JSON that is kept with the clip, or ""."""
    record = clips.find(clip) if clip else None
    return record.face_fit if record else ""


def is_calibrated(clip: bpy.types.MovieClip | None) -> bool:
    """Whether the clip's fit knows this person's skin and muscles."""
    try:
        fit = of_clip(clip)
    except native.known_errors():
        return False
    return bool(fit and fit.calibration.frames)


def summary(clip: bpy.types.MovieClip) -> str:
    """What is known of the person in the clip, in a few words."""
    try:
        fit = of_clip(clip)
    except native.known_errors() as error:
        return str(error)
    if fit is None:
        return iface_("face not found yet")
    num_pins = sum(map(len, fit.pins.values()))
    parts = [iface_("face of frame {frame}").format(frame=fit.frame)]
    if num_pins:
        text = iface_("{count} pins") if num_pins > 1 else iface_("1 pin")
        parts.append(text.format(count=num_pins))
    parts += [iface_("calibrated")] if fit.calibration.frames else []
    return ", ".join(parts)


def rest_remark(clip: bpy.types.MovieClip) -> str:
    """Which frame is taken as rest, and why; "" without a fit."""
    try:
        fit = of_clip(clip)
    except native.known_errors():
        return ""
    if fit is None:
        return ""
    rest = fit.rest
    return iface_(rest.template).format(frame=fit.frame, seen=rest.seen, alike=rest.alike)


def lens_remark(clip: bpy.types.MovieClip) -> str:
    """What to say where the face was found with another lens than the clip has now, or ""."""
    try:
        fit = of_clip(clip)
    except native.known_errors():
        return ""
    return clip_lens.remark(clip, fit) if fit else ""


def of_clip(clip: bpy.types.MovieClip | None):
    """The clip's FaceFit, or None; raises InvalidInput if its JSON was edited and is no fit."""
    text = content(clip)
    if not text:
        return None
    if text not in _fits:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "face.json")
            path.write_text(text, encoding="utf-8")
            _remember(text, native.fitting().FaceFit.load(path))
    return _fits[text]


def _remember(text: str, fit) -> None:
    while len(_fits) >= MOST_PARSED:
        _fits.pop(next(iter(_fits)))
    _fits[text] = fit
