# SPDX-License-Identifier: GPL-3.0-or-later
"""From footage to a calibrated fit: the capture, keeping where the skin was seen."""

from __future__ import annotations

import os
from dataclasses import replace

import numpy as np

from mimetic import InvalidInput, _core
from mimetic.fit.fitting import FaceFit
from mimetic.fit.known_lens import KnownLens
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import Anatomy, AttachedSkin, modes_of
from mimetic.muscles.calibration import Calibration
from mimetic.shared.progress import ATTACHED, SEARCHED, Progress, stages
from mimetic.skin.mesh import SkinMesh
from mimetic.solve import clip_capture
from mimetic.solve.calibrate import CalibrationResult, estimate
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_capture import ClipCapture, FrameRange
from mimetic.solve.walk import Image, Pose

LEAST_FRAMES = 15  # in which the face was followed
MOST_FRAMES = 600  # of footage: 20 s show what there is, and all are kept in memory
WEIGHED = 1.8  # of what following costs, for the progress: all rounds


class _ObservedCapture(ClipCapture):
    """A capture that keeps where the skin was seen in every frame that was followed."""

    sightings: list[_core.Sighting]

    def attach(self, skin: AttachedSkin) -> Anatomy:
        return modes_of(skin)  # what is calibrated

    def advance(
        self, tracker: _core.FaceTracker, frame: int, image: Image, guess: Pose | None = None
    ) -> _core.FrameEstimate:
        state = super().advance(tracker, frame, image, guess)
        first, last = self.walk.frames
        if not state.held and first <= frame <= last:
            self.sightings.append(_core.Sighting.of(frame, state, tracker.observations()))
        return state


def calibrate(
    path: str | os.PathLike[str],
    frames: FrameRange | None = None,
    fit: FaceFit | None = None,
    progress: Progress | None = None,
    lens: KnownLens | None = None,
) -> tuple[FaceFit, CalibrationResult]:
    """The fit with the calibration that `frames` of the footage make most probable.

    fit: of this footage, found if there is none, with `lens` if that is known; what it was
    calibrated to before is replaced.
    progress: as in `clip_capture.capture`; False raises KeyboardInterrupt. Raises NothingSeen where
    no expression was seen, NoFace, UnreadableMedia, InvalidInput.
    """
    footage = Footage(path)
    first, last = clip_capture.check_range(frames, footage)
    num_frames = last - first + 1
    if not LEAST_FRAMES <= num_frames <= MOST_FRAMES:
        raise InvalidInput(
            f"calibration rests on {LEAST_FRAMES} to {MOST_FRAMES} frames, {first}:{last} are "
            f"{num_frames}: choose a few seconds in which the face moves (--frames A:B)"
        )
    summary = CaptureSummary()
    weighing_cost = WEIGHED * (ATTACHED + num_frames)
    finding, attaching, following, weighing = stages(
        progress, 0.0 if fit else SEARCHED, ATTACHED, num_frames, weighing_cost
    )
    fit = clip_capture.fit_for(footage, (first, last), fit, finding, summary, lens)
    fit = replace(fit, calibration=Calibration())
    capture = _ObservedCapture(footage, fit, (first, last), following, summary, attaching)
    capture.sightings = []
    capture.run()
    if summary.stopped:
        raise KeyboardInterrupt
    if len(capture.sightings) < LEAST_FRAMES:
        raise InvalidInput(
            f"{footage.path.name}: the face was followed in {len(capture.sightings)} of the frames "
            f"{first} to {last}, calibration needs {LEAST_FRAMES}: choose others (--frames A:B)"
        )
    mesh = SkinMesh(capture.template, np.ascontiguousarray(capture.neutral))
    result = estimate(
        mesh,
        capture.sightings,
        fit.camera,
        fit.head_pose,
        lambda fraction: weighing(fraction, "weighing the evidence"),
    )
    return replace(fit, calibration=result.calibration), result
