# SPDX-License-Identifier: GPL-3.0-or-later
"""What the curves of the face's baked take may be off by, as its capture has it."""

from __future__ import annotations

from dataclasses import dataclass

from bpy.app.translations import pgettext_iface as iface_

from . import native, performance_files, scene_in, scene_out, shown_take, takes
from .scene_out import gaze

MOST = 8  # selected curves that are told of: more would hide each other


@dataclass(frozen=True)
class BakedErrors:
    """The take that plays on a face, and its error bars."""

    row: object  # of the face's takes, `take_rows.MimeticTake`
    bars: object  # mimetic.report.error_bars.ErrorBars
    curves: list  # of `scene_out.face_curves.FaceCurve`: selected, shown, and with error bars

    @property
    def step(self) -> float:
        """Scene frames from one footage frame to the next."""
        row = self.row
        return (row.scene_last - row.scene_first) / max(row.last - row.first, 1)

    def footage_frame(self, scene_frame: float) -> int:
        step = self.step or 1.0
        return round(self.row.first + (scene_frame - self.row.scene_first) / step)


_last: tuple | None = None  # what the error bars were made of, and they


def of_selected(context) -> BakedErrors | str:
    """Of the selected curves in a Graph Editor, or why there is nothing to tell."""
    face = scene_in.shown_face(context)
    if face is None:
        return "Bake a take first: error bars are of its curves"
    row = scene_out.take_list.playing(face)
    if row is None:
        return iface_("{name} plays no baked take").format(name=face.name)
    take = takes.of_baked(row)
    if take is None:
        return iface_("{file}, which {take} was baked from, is missing").format(
            file=row.performance, take=row.name
        )
    try:
        performance = shown_take.of(take)
    except native.known_errors() as error:
        return str(error)
    is_same_part = (performance.frame[0], performance.frame[-1]) == (row.first, row.last)
    if not is_same_part or not performance_files.holds(take.path, row):
        return iface_("{file} holds another capture than {take} was baked from").format(
            file=row.performance, take=row.name
        )
    bars = _bars(performance, not gaze.turns(face))
    curves = [one for one in _selected(context, face) if bars.has(one.shape)]
    if not curves:
        return "Select a curve of a muscle, the jaw, lids or lips"
    if len(curves) > MOST:
        active = getattr(context, "active_editable_fcurve", None)
        curves = [one for one in curves if active is not None and one.curve == active]
        if not curves:
            return iface_("Select at most {count} curves").format(count=MOST)
    return BakedErrors(row, bars, curves)


def _selected(context, face) -> list:
    """The face's curves that are selected; in a Graph Editor, of those that it shows."""
    curves = [one for one in scene_out.face_curves.of(face) if one.curve.select]
    if (visible := getattr(context, "visible_fcurves", None)) is None:
        return curves
    shown = {curve.as_pointer() for curve in visible}
    return [one for one in curves if one.curve.as_pointer() in shown]


def line_of(found: BakedErrors, curve, scene_frame: float) -> str:
    """A curve's captured value at a frame of the scene, and how far it may be off."""
    bar = found.bars.at(curve.shape, found.footage_frame(scene_frame))
    if bar is None:
        return iface_("{name}: not measured in this frame").format(name=curve.shape)
    text = iface_("{name}: {value:.2f} ± {half:.2f}").format(
        name=curve.shape, value=bar.value, half=bar.half
    )
    if bar.confounded_with:
        text += iface_(", not told apart from {other}").format(other=bar.confounded_with)
    return text


def _bars(performance, has_gaze_sliders: bool):
    global _last
    if _last is None or _last[0] is not performance or _last[1] != has_gaze_sliders:
        made = native.error_bars().ErrorBars(performance, has_gaze_sliders)
        _last = (performance, has_gaze_sliders, made)
    return _last[2]


def forget() -> None:
    global _last
    _last = None
