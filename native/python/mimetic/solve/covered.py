# SPDX-License-Identifier: GPL-3.0-or-later
"""What is before the face: glasses, a hand, a caption. What it hides is not measured."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.fitting import FaceFit
from mimetic.locate.feature_networks import occlusion_network
from mimetic.shared.counted import counted
from mimetic.solve.glasses import notes_on_glasses
from mimetic.solve.tracking import measured_skin
from mimetic.solve.walk import runs_of
from mimetic.template.face_template import FaceTemplate

COVERED = 0.05  # share of what is measured of the face, from which it is told
STILL = 0.01  # the same of what stands still in the picture, which hides as much in each frame
JOINED, MOST_NAMED = 5, 4  # frames between spans that count as one; spans in a note


class CoverWatch:
    """What was before the face in the frames of a capture, for its notes.

    image: (H, W, 3) uint8, the footage's frame number `fit.frame`
    """

    def __init__(self, image: NDArray[np.uint8], fit: FaceFit, template: FaceTemplate) -> None:
        self._rest = fit.frame
        self._of_rest = notes_on_glasses(image, fit, template)
        square = _core.occlusion_square(fit.camera, np.asarray(fit.head_pose, dtype=np.float64))
        self._is_hidden = occlusion_network().see(np.ascontiguousarray(image), square).is_sure()
        self._frames: set[int] = set()
        self._is_still = _still_share(fit, template) > STILL

    def add(self, frame: int, estimate: _core.FrameEstimate) -> None:
        if estimate.covered > COVERED:
            self._frames.add(frame)

    def notes(self, frames: Iterable[int]) -> list[str]:
        """What a user of these frames should know."""
        notes = list(self._of_rest)
        if self._is_hidden:
            notes.append(
                f"something is before the face in frame {self._rest}, from which it is followed: "
                "what is hidden there is guessed; name a frame in which the face is bare (--rest "
                "FRAME)"
            )
        if self._is_still:
            notes.append(
                "something stands still in the picture before the face, as a caption, a logo or a "
                "microphone does: what it hides is not measured, and the error bars of what moves "
                "there are wider"
            )
        if spans := runs_of(sorted(self._frames & set(frames)), JOINED):
            named = [f"{a} to {b}" if b > a else str(a) for a, b in spans[:MOST_NAMED]]
            if len(spans) > MOST_NAMED:
                named.append(counted(len(spans) - MOST_NAMED, "further span"))
            notes.append(
                f"something is before the face in frames {', '.join(named)}: what it hides is not "
                "measured, and the error bars of what moves there are wider"
            )
        return notes


def _still_share(fit: FaceFit, template: FaceTemplate) -> float:
    """The share of what is measured of the face that stands behind it in the fit's frame."""
    still = fit.still_cover.in_core()
    if still is None:
        return 0.0
    measured = measured_skin(fit.neutral_vertices(template), template)
    return float(still.at(fit.camera.pixels(measured, fit.head_pose)).mean())
