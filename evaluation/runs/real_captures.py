# SPDX-License-Identifier: GPL-3.0-or-later
"""Performances of the marked real clips: those that an earlier run kept, or captured anew."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from mimetic import InvalidInput
from mimetic.media.footage import Footage
from mimetic.performance.document import Performance
from mimetic.solve import clip_capture

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


def captured(clip: str, last: int, report: Report, folder: Path | None = None) -> Performance:
    """A clip's performance from the folder if it is there, or captured from frame 1 to `last`."""
    if folder is not None and (folder / f"{clip}.npz").is_file():
        return Performance.load(folder / f"{clip}.npz")
    footage = Footage(footage_of(clip))
    last = min(last, footage.num_frames)
    report(f"{clip}: capture, {last} frames")
    return clip_capture.capture(footage.path, (1, last))
