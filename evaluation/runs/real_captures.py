# SPDX-License-Identifier: GPL-3.0-or-later
"""Performances of the marked real clips: those that an earlier run kept, or captured anew."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from mimetic import InvalidInput
from mimetic.fit.face_fit import FaceFit
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.solve import clip_capture
from mimetic.solve.capture_summary import CaptureSummary

from evaluation.runs.real_labels import CLIPS, footage_of

Report = Callable[[str], None]


def kept_clips(folder: Path | None) -> list[str]:
    """The clips whose performances (NAME.npz) a folder has, all without one.

    Raises InvalidInput if it has none of them.
    """
    clips = [clip for clip in CLIPS if folder is None or (folder / f"{clip}.npz").is_file()]
    if not clips:
        text = f"{folder} has no performance of {', '.join(CLIPS)}; `real --out` leaves them"
        raise InvalidInput(text)
    return clips


def captured(
    clip: str,
    last: int,
    report: Report,
    folder: Path | None = None,
    summary: CaptureSummary | None = None,
) -> Performance:
    """A clip's performance from the folder if it is there, or captured from frame 1 to `last`.

    summary: filled in by a capture
    """
    if folder is not None and (folder / f"{clip}.npz").is_file():
        return Performance.load(folder / f"{clip}.npz")
    footage = Footage(footage_of(clip))
    last = min(last, footage.num_frames)
    report(f"{clip}: capture, {last} frames")
    return clip_capture.capture(footage.path, (1, last), summary=summary)


def captured_person(
    clip: str, last: int, report: Report, folder: Path | None = None
) -> tuple[Performance, FaceFit]:
    """The same, and the fit that it rests on with how far the person's muscles go.

    Of a folder NAME.fit.json, if it is there; otherwise the face is found again.
    """
    if folder is not None and (folder / f"{clip}.fit.json").is_file():
        return captured(clip, last, report, folder), FaceFit.load(folder / f"{clip}.fit.json")
    summary = CaptureSummary()
    performance = captured(clip, last, report, folder, summary)
    if summary.fit is not None:
        return performance, summary.fit
    footage = Footage(footage_of(clip))
    report(f"{clip}: find the face")
    fit = clip_capture.find_face(footage.path, None, (1, min(last, footage.num_frames)))
    if performance.muscle_extent is None:
        return performance, fit
    names_and_extents = zip(performance.muscles, performance.muscle_extent.tolist(), strict=True)
    extent = {name: times for name, times in names_and_extents if times > 1}
    return performance, replace(fit, calibration=replace(fit.calibration, extent=extent))
