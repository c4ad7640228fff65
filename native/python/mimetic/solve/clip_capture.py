# SPDX-License-Identifier: GPL-3.0-or-later
"""From footage to a performance: the loop over the frames.

`find_face` chooses a frame and fits the head; `capture` follows it through the clip. Memory does
not depend on the clip's length but for the performance itself: frames are decoded one at a time.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mimetic import InvalidInput, UnreadableMedia, _core
from mimetic.fit.fitting import FaceFit, NoFace
from mimetic.fit.known_lens import KnownLens
from mimetic.fit.same_footage import check_same_footage
from mimetic.fit.upright import check_upright
from mimetic.locate.feature_networks import installed_networks
from mimetic.media.footage import Footage
from mimetic.muscles.anatomy import FACTORED, Anatomy, AttachedSkin, modes_of, refined_skin
from mimetic.muscles.detail import detail_of
from mimetic.muscles.extras import with_lip_shapes
from mimetic.performance.confounding import with_confounding
from mimetic.performance.corrections import Corrections
from mimetic.performance.document import Performance
from mimetic.performance.projection import rescaled
from mimetic.performance.rows import Rows, State
from mimetic.shared.parallel import both
from mimetic.shared.progress import (
    ATTACHED,
    FOUND,
    JUDGED,
    MOST_FOLLOWED,
    NUM_CANDIDATES,
    SEARCHED,
    Progress,
    stages,
)
from mimetic.solve import full_range, smoothing, tracking
from mimetic.solve.capture_summary import CaptureSummary
from mimetic.solve.clip_performance import clip_performance
from mimetic.solve.covered import CoverWatch
from mimetic.solve.find_face import Rest, find_rest, joined_with_others, rest_asked_for
from mimetic.solve.frames_so_far import FramesSoFar
from mimetic.solve.gaze import ClipGaze
from mimetic.solve.refining import check_of_capture, refined, within
from mimetic.solve.texture_size import tracker_options
from mimetic.solve.walk import ClipWalk, Image, Pose, before_range, proved
from mimetic.template.face_template import load_template

FrameRange = tuple[int | None, int | None]
# By frame, in the order of following; None where nothing can be measured
Estimates = Iterator[tuple[int, _core.FrameEstimate | None]]
Place = tuple[float, float]  # x, y, pixels of the footage's file

SEARCHED_SECONDS = 10.0  # of the clip, for the frame that shows the face best
# Share of the turn since the reference frame: what a fitted depth that is wrong makes of it
# [Belhumeur et al. 1999, the bas-relief ambiguity]; `mimetic evaluate --set full-tuning`.
TURN_ERROR = 0.02
NUM_TURNED = 3  # frames in which a face that lies on its side is looked for, if none was found


def find_face(
    path: str | os.PathLike[str] | Footage,
    frame: int | None = None,
    frames: FrameRange | None = None,
    progress: Progress | None = None,
    near: Place | None = None,
    lens: KnownLens | None = None,
) -> FaceFit:
    """The head fitted to `frame`, or to the best of the first seconds (within `frames`).

    The face must be at rest there. Of several the largest is taken, or the one nearest to `near`.
    The frame is joined by others near it (within `frames`) in which the head is turned otherwise
    (`FaceFit.views`); `FaceFit.rest` says why it was taken. lens: that it was filmed with, if
    known. path: of footage, or footage that is open. Raises NoFace, UnreadableMedia, InvalidInput.
    """
    footage = path if isinstance(path, Footage) else Footage(path)
    if near is not None:
        if not all(0 <= at < side for at, side in zip(near, footage.stored_size, strict=True)):
            width, height = footage.stored_size
            raise InvalidInput(
                f"no face is looked for at ({near[0]:g}, {near[1]:g}): the picture has "
                f"{width} x {height} pixels"
            )
        x, y = rescaled(near, footage.stored_size, footage.size)[0]
        near = float(x), float(y)
    first, last = check_range(frames, footage)
    check_rest(frame, footage)
    asked_cost = (NUM_CANDIDATES * JUDGED, ATTACHED + MOST_FOLLOWED)
    finding, joining = stages(progress, *((FOUND, MOST_FOLLOWED) if frame is None else asked_cost))
    if frame is not None:
        others = _spread(*_seconds_about(frame, (first, last), footage), NUM_CANDIDATES)
        rest = rest_asked_for(footage, frame, others, finding, near, lens)
    else:
        rest = rest_in(footage, (first, last), finding, near, lens)
        check_upright(footage, rest.fit.frame, footage.read(rest.fit.frame), rest.fit)
    return joined_with_others(footage, rest, joining)


def rest_in(
    footage: Footage,
    frames: tuple[int, int],
    progress: Progress = lambda _fraction, _text: True,
    near: Place | None = None,
    lens: KnownLens | None = None,
) -> Rest:
    """The face at rest in the first seconds of these frames, or later; near: as `find_rest` has it.
    Raises NoFace."""
    first, last = frames
    end = min(last, first + max(1, round(SEARCHED_SECONDS * float(footage.fps))))
    searching, once_more = stages(progress, 1.0, 0.0)
    rest = find_rest(footage, _spread(first, end, NUM_CANDIDATES), searching, near, lens)
    if rest is None and end < last:
        rest = find_rest(footage, _spread(end + 1, last, 2 * NUM_CANDIDATES), once_more, near, lens)
    if rest is None and footage.failure:
        raise footage.failure
    if rest is None:
        for one in sorted(_spread(first, last, NUM_TURNED)):
            with contextlib.suppress(UnreadableMedia):  # a damaged end
                check_upright(footage, one, footage.read(one))
        at = "" if near is None else f" near ({near[0]:.0f}, {near[1]:.0f})"
        where = f"{footage.path.name}{at}"
        raise NoFace(
            f"no frontal face found in {where}, frames {first} to {last}: choose a"
            " range in which the face looks at the camera and is lit (--frames A:B), or give a fit"
        )
    return rest


def _seconds_about(frame: int, frames: tuple[int, int], footage: Footage) -> tuple[int, int]:
    """The part of `frames` that is looked at beside a frame: as long as is searched for rest."""
    first, last = frames
    num_frames = max(1, round(SEARCHED_SECONDS * float(footage.fps)))
    begin = max(first, min(frame - num_frames // 2, last - num_frames))
    return begin, min(last, begin + num_frames)


def _spread(first: int, last: int, number: int) -> set[int]:
    """At most `number` frames from `first` to `last`, evenly."""
    return set(np.linspace(first, last, min(number, last - first + 1)).astype(int).tolist())


def check_range(frames: FrameRange | None, footage: Footage) -> tuple[int, int]:
    """First and last frame number, both included; raises InvalidInput."""
    first, last = frames or (None, None)
    first = 1 if first is None else first
    last = footage.num_frames if last is None else min(last, footage.num_frames)
    if frames and frames[0] and frames[1] and frames[0] > frames[1]:
        raise InvalidInput(
            f"frames {frames[0]}:{frames[1]} of {footage.path.name}: the first is after the last"
        )
    if first < 1 or first > last:
        begin, end = ("" if end is None else end for end in frames or (first, last))
        raise InvalidInput(
            f"frames {begin}:{end} of {footage.path.name}: it has frames 1 to {footage.num_frames}"
        )
    return first, last


def check_rest(frame: int | None, footage: Footage) -> None:
    """Raises InvalidInput if the footage has no such frame."""
    if frame is not None and not 1 <= frame <= footage.num_frames:
        raise InvalidInput(
            f"frame {frame} is to show the face at rest, but {footage.path.name} has frames 1 to "
            f"{footage.num_frames}: choose one of them (--rest FRAME)"
        )


def fit_for(
    footage: Footage,
    frames: tuple[int, int],
    fit: FaceFit | None,
    progress: Progress | None,
    summary: CaptureSummary,
    lens: KnownLens | None = None,
) -> FaceFit:
    """The fit to follow a clip from: the given one, or found in `frames`; noted in `summary`.

    Raises InvalidInput for a fit of other pictures, NoFace.
    """
    start = time.perf_counter()
    if fit is None:
        fit = find_face(footage, frames=frames, progress=progress, lens=lens)
    elif tuple(fit.image_size) != footage.size:
        raise InvalidInput(
            f"the face fit is for pictures of {fit.image_size[0]} x {fit.image_size[1]}, "
            f"{footage.path.name} has {footage.size[0]} x {footage.size[1]}"
        )
    else:
        check_same_footage(fit, footage.read(fit.frame), footage.path.name)
    summary.fit, summary.footage = fit, footage
    summary.add("find the face", time.perf_counter() - start)
    return fit


def capture(
    path: str | os.PathLike[str],
    frames: FrameRange | None = None,
    fit: FaceFit | None = None,
    progress: Progress | None = None,
    summary: CaptureSummary | None = None,
    corrections: Corrections = (),
    so_far: FramesSoFar | None = None,
    lens: KnownLens | None = None,
) -> Performance:
    """Follows the head and solves the muscles in `frames` (both ends included; the whole clip).

    progress: called with (fraction, text) every frame; when it returns False the frames done so far
    are returned, and `notes` say so. summary: filled with how it went. corrections: what a person
    says of some of the frames, measured beside the pictures. so_far: given each frame as soon as
    it is followed. lens: that a face without a fit is found with, if it is known. Raises NoFace,
    UnreadableMedia, InvalidInput.
    """
    summary = summary if summary is not None else CaptureSummary()
    footage = Footage(path)
    first, last = check_range(frames, footage)
    check_of_capture(corrections, (first, last))
    if first == last:
        raise InvalidInput(
            f"{footage.path.name}: one frame ({first}) shows no motion; capture needs at least two"
        )
    reached = (first, last, fit.frame) if fit else (first, last)
    finding, attaching, following = stages(
        progress, 0.0 if fit else SEARCHED, ATTACHED, 1 + max(reached) - min(reached)
    )
    fit = fit_for(footage, (first, last), fit, finding, summary, lens)
    walk = ClipCapture(footage, fit, (first, last), following, summary, attaching)
    walk.so_far = so_far
    walk.pinned_poses = {c.frame: c.pose.head_pose for c in corrections if c.pose is not None}
    performance = walk.run()
    if corrections:
        start = time.perf_counter()
        performance = refined(performance, within(corrections, performance))
        summary.add("honour the corrections", time.perf_counter() - start)
    return performance


class ClipCapture:
    """One capture at work; how it makes its tracker, advances and smooths may be varied.

    progress: of following; attaching: of attaching the muscles, before it. Raises UnreadableMedia
    where that says to stop: there is no frame to keep.
    """

    def __init__(
        self,
        footage: Footage,
        fit: FaceFit,
        frames: tuple[int, int],
        progress: Progress | None,
        summary: CaptureSummary,
        attaching: Progress | None = None,
    ) -> None:
        self.walk = ClipWalk(footage, fit, frames, progress, summary, "face")
        self.pinned_poses: dict[int, Pose] = {}  # by frame: where a lost face is
        self.so_far: FramesSoFar | None = None  # who looks at frames before they are smoothed
        self._is_lost = False
        start = time.perf_counter()
        self.template = load_template()
        self.neutral = fit.neutral_vertices(self.template)
        attaching = _telling(attaching, before_range(fit, frames))
        skin = refined_skin(self.neutral, self.template, fit.calibration, attaching)
        if skin is not None:
            mesh = skin.mesh
            self.anatomy, self.detail = both(
                lambda: self.attach(skin), lambda: detail_of(mesh, tracking.UNMEASURED)
            )
        if skin is None or (attaching and not attaching(FACTORED, "attaching the muscles")):
            raise UnreadableMedia(f"{footage.path.name}: stopped too early, no frame is done")
        self.motion = tracking.face_motion(
            *(self.neutral, self.template, self.anatomy, self.detail),
            neutral_depth_std=fit.neutral_depth_std(self.template),
        )
        summary.add("attach the muscles", time.perf_counter() - start)

    def attach(self, skin: AttachedSkin) -> Anatomy:
        """What moves the skin: the lips' shapes too, where the networks see their edges."""
        anatomy = modes_of(skin)
        return with_lip_shapes(anatomy, skin) if installed_networks() else anatomy

    def run(self) -> Performance:
        reference_frame, (first, last) = self.walk.fit.frame, self.walk.frames
        reference = self.walk.footage.read(reference_frame)
        if self.so_far is not None:
            self.so_far.begin(self.walk.fit, self.template, self.anatomy, self.detail)
        tracker = self.make_tracker(reference)
        self._cover = CoverWatch(reference, self.walk.fit, self.template)

        def step(frame: int, image: Image, guess: Pose | None = None) -> _core.FrameEstimate:
            estimate = self.advance(tracker, frame, image, guess)
            if self.so_far is not None:
                self.so_far.add(frame, estimate, 1 / float(self.walk.footage.fps))
            return estimate

        at_reference = step(reference_frame, reference)
        backward, forward = Rows(), Rows()
        near_reference: list[tuple[int, _core.FrameEstimate]] = []
        if reference_frame > first:
            behind = proved(self.walk.follow(first, step, reference))
            for state in self.smooth(behind, [(reference_frame, at_reference)]):
                if (
                    len(near_reference) == len(backward.frame) < smoothing.OVERLAP
                    and not state.held
                    and not self.walk.is_cut_between(state.frame, state.frame + 1)
                ):
                    near_reference.append((state.frame, state.estimate))
                if state.frame <= last:
                    backward.append(state)
            tracker.restart(reference, at_reference)
        ahead: Estimates = iter(())
        if last > reference_frame:
            ahead = proved(self.walk.follow(last, step, reference))
        estimates = itertools.chain([(reference_frame, at_reference)], ahead)
        for state in self.smooth(estimates, near_reference[::-1]):
            if first <= state.frame <= last:
                forward.append(state)
        return self._performance(backward.reversed() + forward, at_reference)

    def smooth(
        self, estimates: Estimates, before: list[tuple[int, _core.FrameEstimate]]
    ) -> Iterator[State]:
        def count(seconds: float) -> None:
            self.walk.summary.add("smooth", seconds)

        options = full_range.smoother_options(float(self.walk.footage.fps))
        return smoothing.smooth_in_windows(
            estimates, before, self.motion, count, options, self.walk.is_cut_between
        )

    def make_tracker(self, reference: NDArray[np.uint8]) -> _core.FaceTracker:
        inputs = (self.walk.fit, self.template, self.anatomy, self.motion)
        return tracking.make_tracker(reference, *inputs, self.tracker_options(reference))

    def tracker_options(self, reference: NDArray[np.uint8]) -> _core.TrackerOptions:
        of_fit = (self.walk.footage, self.walk.fit, self.neutral, self.template)
        return tracker_options(reference, *of_fit)

    def advance(
        self, tracker: _core.FaceTracker, frame: int, image: Image, guess: Pose | None = None
    ) -> _core.FrameEstimate:
        if self._is_lost:
            guess = self.pinned_poses.get(frame, guess)
        estimate = tracker.advance(image, guess)
        self._is_lost = estimate.held
        self._cover.add(frame, estimate)
        self.walk.summary.add_tracker(estimate.times)
        return estimate

    def _performance(self, rows: Rows, at_fit: _core.FrameEstimate) -> Performance:
        self.walk.check_any_done(rows)
        fit = self.walk.fit
        num_muscles = len(self.anatomy.muscle_names)
        values, std = np.array(rows.values), np.array(rows.values_std)
        of_muscles = values[:, :num_muscles], std[:, :num_muscles]
        fit = full_range.with_extent(fit, self.anatomy.muscle_names, *of_muscles)
        self.walk.summary.fit = fit
        poses = rows.rigid_poses()
        pose_cov = rows.pose_covariances()
        pose_cov[:, :3, :3] += _of_the_turn(poses, fit.head_pose)
        fps = float(self.walk.footage.fps)
        gaze = ClipGaze(fit, self.template, rows, at_fit, fps, self.walk.scene_starts)
        of_values = gaze.fields(
            list(self.anatomy.articulator_names),
            values[:, num_muscles:],
            std[:, num_muscles:],
            self.anatomy.articulator_modes,
        ) | full_range.stated(*(fit, self.anatomy, *of_muscles), np.array(rows.evidence))
        about = self._cover.notes(rows.frame)
        performance = clip_performance(
            *(rows, self.walk.footage, fit, self.template, self.anatomy),
            scene_starts=self.walk.scene_starts,
            head_pose=poses,
            head_pose_cov=pose_cov,
            **of_values,
            detail_modes=self.detail.modes,
            detail_coefficients=np.array(rows.detail),
            detail_coefficients_std=np.array(rows.detail_std),
            notes=self.walk.notes(rows, [*about, *fit.calibration.notes()]) or None,
        )
        return with_confounding(performance)


def _telling(progress: Progress | None, way: str) -> Progress | None:
    """A progress that also says what comes next, if anything is to be said."""
    if progress is None or not way:
        return progress
    return lambda fraction, text: progress(fraction, f"{text}; then {way}")


def _of_the_turn(poses: NDArray[np.float64], reference: NDArray[np.float64]) -> NDArray[np.float64]:
    """N x 3 x 3 rad^2, about every axis alike: what the fit's depth adds to the rotation's."""
    std = TURN_ERROR * _core.angles_from(poses, reference)
    return std[:, None, None] ** 2 * np.eye(3)
