# SPDX-License-Identifier: GPL-3.0-or-later
"""Walking through a clip after a face or a head: cuts, searches, and what to say in the end."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mimetic import UnreadableMedia, _core
from mimetic.fit import fitting
from mimetic.fit.fitting import FaceFit, NoFace
from mimetic.media.footage import Footage
from mimetic.performance.document import HELD_QUALITY
from mimetic.performance.rows import Rows

Estimate = TypeVar("Estimate", _core.FrameEstimate, _core.HeadEstimate)
SEARCH_AGAIN = 6  # frames between looks for a face that was lost: twice in half a second
PROOF = 3  # frames on end in which a face that was lost must be found, to be this one


def find_again(image: NDArray[np.uint8], frame: int, fit: FaceFit) -> NDArray[np.float64] | None:
    """Where the detector sees a lost head, camera from head.

    Of several faces the one nearest to where the fit has its own: who was chosen stays chosen.
    """
    try:
        near = fit.head_place()
        return fitting.find_face(image, frame, camera=fit.camera, near=near).head_pose
    except NoFace:
        return None


def proved(
    estimates: Iterable[tuple[int, Estimate | None]],
) -> Iterator[tuple[int, Estimate | None]]:
    """The estimates, None where a lost face was found, but not for PROOF frames on end.

    Chance makes another face look like this one in a frame, not in several. A face may be lost and
    found in one frame, and after a cut it was not lost before: `found_again` tells.
    """
    is_lost = False
    waiting: list[tuple[int, Estimate | None]] = []
    for frame, estimate in estimates:
        if estimate is None or estimate.held:
            yield from ((earlier, None) for earlier, _ in waiting)
            waiting, is_lost = [], True
            yield frame, estimate
        elif is_lost or estimate.found_again:
            is_lost = True
            waiting.append((frame, estimate))
            if len(waiting) == PROOF:
                yield from waiting
                waiting, is_lost = [], False
        else:
            yield frame, estimate
    yield from ((earlier, None) for earlier, _ in waiting)


def check_any_done(rows: Rows, footage: Footage, frames: tuple[int, int], stopped: bool) -> None:
    """Raises UnreadableMedia, or what ffmpeg failed by, if no frame was done, or one of many.

    One of many is the reference frame alone, which is the fit and no result.
    """
    is_fit_alone = len(rows.frame) == 1 and frames[0] != frames[1]
    if footage.failure and (not rows.frame or is_fit_alone):
        raise footage.failure
    if not rows.frame or (is_fit_alone and stopped):
        why = "stopped too early" if stopped else "the file ends before"
        raise UnreadableMedia(
            f"{footage.path.name}: {why}, no frame of {frames[0]} to {frames[1]} is done"
        )
    if is_fit_alone:
        raise UnreadableMedia(
            f"{footage.path.name} is damaged: of frames {frames[0]} to {frames[1]} only "
            f"{rows.frame[0]} can be read, which shows no motion; copy or record it again"
        )


def notes_on(rows: Rows, frames: tuple[int, int], stopped: bool, followed: str) -> list[str]:
    """An early stop and held frames; `followed`: the face, the head."""
    notes = []
    if stopped:
        notes.append(
            f"stopped by the user: frames {rows.frame[0]} to {rows.frame[-1]} "
            f"of {frames[0]} to {frames[1]}"
        )
    held = int(np.sum(np.array(rows.quality) < HELD_QUALITY))
    if held:
        notes.append(
            f"the {followed} was lost in {held} frames, which are held (quality under 0.2)"
        )
    return notes


def notes_on_strangers(frames: list[int]) -> list[str]:
    """One note a run of frames in which a face was seen, but not followed: it is not this one."""
    runs: list[list[int]] = []
    for frame in sorted(set(frames)):
        if runs and frame - runs[-1][-1] <= SEARCH_AGAIN:
            runs[-1].append(frame)
        else:
            runs.append([frame])
    return [
        f"frames {run[0]} to {run[-1]} show a face that does not look like the fitted one (another "
        "person's, or covered): held, not captured"
        for run in runs
    ]
