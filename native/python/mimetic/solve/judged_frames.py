# SPDX-License-Identifier: GPL-3.0-or-later
"""What a clip's frames show of a face before a head is fitted to one of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit import fitting
from mimetic.fit.face_fit import FaceFit
from mimetic.fit.rest_choice import RestChoice
from mimetic.fit.still_cover import StillCover
from mimetic.fit.views import Candidate
from mimetic.media.footage import Footage
from mimetic.shared.parallel import in_turn
from mimetic.shared.progress import frame_text

NEAR_ENOUGH = 2.0  # widths of a face, from a place or from frame to frame; farther is another's
LESS_COVERED = 0.25  # quantile of what is before the face that is usual in the clip
MORE_COVERED = 0.06  # share of the face; frames in which so much more is covered show no rest


def widths_away(face: _core.FaceFeatures, place: Sequence[float] | NDArray[np.float64]) -> float:
    """How far a place (x, y), pixels, is from a face's middle, in widths of the face."""
    return math.dist(fitting.middle_of(face), place) / float(face.box[2])


@dataclass(frozen=True)
class JudgedFrames:
    """The frames in which a face was found.

    clear: with nothing more before it than is usual in the clip: no hand that passes. covered: the
    others; still_cover: what stands still in the picture before it in all of them.
    """

    clear: dict[int, fitting.Judged]
    covered: set[int]
    still_cover: StillCover

    def compared(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Scores (F,), expressions (F, 6) and details (F,) of the clear ones, in their order."""
        rows = self.clear.values()
        expressions, details = (
            np.array([getattr(one, n) for one in rows]) for n in ("expression", "detail")
        )
        return _core.rest_scores([one.signs for one in rows]), expressions, details

    def candidates(self, usual: NDArray[np.float64]) -> list[Candidate]:
        """The clear ones, with how near to the usual expression (F,) each is."""
        return [
            Candidate(frame, one.features, float(share))
            for (frame, one), share in zip(self.clear.items(), usual, strict=True)
        ]

    def explained(self, fit: FaceFit, why: str) -> FaceFit:
        """The fit with the reason why its frame, a clear one, was taken."""
        _, expressions, _ = self.compared()
        alike = _core.num_alike(expressions, list(self.clear).index(fit.frame))
        return replace(fit, rest=RestChoice(why, len(self.clear), alike))


def judged_frames(
    footage: Footage,
    frame_numbers: set[int],
    go_on: Callable[[float, str], None],
    near: tuple[float, float] | None,
    asked: int | None = None,
) -> JudgedFrames:
    """What is measured in those of `frame_numbers` that show a face, of one person if there are
    several.

    go_on: is told the fraction done and what is done; near: a place (x, y) in pixels where the
    face is in one of them at least; asked: the frame in which it is, and which counts as clear
    whatever is before it.
    """
    first, last = min(frame_numbers), max(frame_numbers)
    images = ((f, image) for f, image in footage.frames(first, last) if f in frame_numbers)
    judgements = {}
    still = _core.StillCoverWatch()
    judged = in_turn(lambda numbered: fitting.judge_frame(numbered[1], near), images)
    for num_seen, ((frame, image), judgement) in enumerate(judged):
        text = f"looking for the face: {frame_text(frame, first, last)}"
        go_on(num_seen / len(frame_numbers), text)
        if judgement is not None:
            judgements[frame] = judgement
            still.add(np.ascontiguousarray(image), judgement.features)
    judgements = _of_one_person(judgements, near, asked)
    if not judgements:
        return JudgedFrames({}, set(), StillCover())
    passing = _core.passing_shares([one.cover for one in judgements.values()])
    most = np.quantile(passing, LESS_COVERED) + MORE_COVERED
    clear = {
        frame: one
        for (frame, one), share in zip(judgements.items(), passing, strict=True)
        if frame == asked or share <= most
    }
    return JudgedFrames(clear, judgements.keys() - clear.keys(), StillCover.of(still.found()))


def _of_one_person(
    judgements: dict[int, fitting.Judged], near: tuple[float, float] | None, asked: int | None
) -> dict[int, fitting.Judged]:
    """Those of the face that was named, or of the largest where a frame shows several.

    Where it is not found, another's is: what is not where the face was in the frame before, from
    a frame that is sure to show it, is left out.
    """
    if not judgements:
        return {}
    if asked in judgements:
        sure = asked
    elif near is not None:
        sure = min(judgements, key=lambda frame: widths_away(judgements[frame].features, near))
        if widths_away(judgements[sure].features, near) > NEAR_ENOUGH:
            return {}
    elif any(len(one.faces) > 1 for one in judgements.values()):
        sure = max(judgements, key=lambda frame: float(judgements[frame].features.box[2]))
    else:
        return judgements
    frames = sorted(judgements)
    start = frames.index(sure)
    kept = {sure}
    for way in (frames[start + 1 :], frames[:start][::-1]):
        last = judgements[sure].features
        for frame in way:
            face = judgements[frame].features
            if widths_away(face, fitting.middle_of(last)) <= NEAR_ENOUGH:
                kept.add(frame)
                last = face
    return {frame: one for frame, one in judgements.items() if frame in kept}
