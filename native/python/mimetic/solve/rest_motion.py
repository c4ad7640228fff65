# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves in a clip's frames, seen from one of them that may not be at rest.

Muscles may go below 0 here: what was contracted in the first frame relaxes in others. Proportions
that look unusual are an expression where other frames leave it, and the person's own where they
do not.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mimetic import _core
from mimetic.fit.face_fit import FaceFit
from mimetic.media.backward import frames_away
from mimetic.media.cuts import of_one_scene
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import AttachedSkin, modes_of
from mimetic.performance.document import HELD_QUALITY
from mimetic.shared.parallel import side_by_side
from mimetic.solve import tracking
from mimetic.solve.face_place import FacePlace
from mimetic.template.face_template import load_template

LOWEST = -1.0  # activation: as far below the supposed rest as muscles go above it
JAW, LIDS = "jaw_open", ("lid_upper.L", "lid_upper.R")


@dataclass(frozen=True)
class Moved:
    """What a frame shows beside the one that was supposed to be at rest."""

    values: NDArray[np.float64]  # activations of the muscles, and the jaw
    lids: NDArray[np.float64]  # 2: of the upper lids, left first, the way from open (0) to shut (1)


def moved_from(
    footage: Footage, fit: FaceFit, frames: set[int], skin: AttachedSkin
) -> Iterator[tuple[int, Moved]]:
    """What moves in those of `frames` to which the face can be followed.

    The fit's own frame is the first. skin: of the fit's head.
    """
    template = load_template()
    anatomy = modes_of(skin)
    neutral = fit.neutral_vertices(template)
    # What contracts together from rest need not relax together into it
    motion = tracking.face_motion(neutral, template, anatomy, lowest=LOWEST, together=False)
    reference = footage.read(fit.frame)
    face = FacePlace(fit).at(fit.head_pose)
    num_muscles = len(anatomy.muscle_names)
    articulators = list(anatomy.articulator_names)
    jaw, *lids = (num_muscles + articulators.index(name) for name in (JAW, *LIDS))

    def told(estimate: _core.FrameEstimate) -> Moved:
        return Moved(estimate.values[[*range(num_muscles), jaw]], estimate.values[lids])

    def followed_to(end: int, tells_own: bool) -> Generator[tuple[int, Moved], None, None]:
        tracker = tracking.make_tracker(reference, fit, template, anatomy, motion)
        own = tracker.advance(reference)
        if tells_own:
            yield fit.frame, told(own)
        images = frames_away(footage, fit.frame, end)
        for frame, image in of_one_scene(reference, images, face):
            if frame not in frames:
                continue
            estimate = tracker.advance(np.ascontiguousarray(image))
            if not estimate.held and estimate.quality >= HELD_QUALITY:
                yield frame, told(estimate)

    ends = sorted({min(frames), max(frames)} - {fit.frame}) or [fit.frame]
    yield from side_by_side([followed_to(end, tells_own=end == ends[0]) for end in ends])
